// Zonal kernels on the sphere: sums whose weight depends on the angle between directions alone.
//
// Prefiltering for n = v = r (Karis 2013) weighs the radiance from l with D(h) (n.l), and there
// (n.h)^2 = (1 + n.l) / 2, so GGX becomes such a zonal kernel: the sum over all texels within reach
// can be written as a plain gather, and, the kernel being symmetric, so can its transpose. Wide
// lobes on fine maps are summed over a pyramid: near texels at full resolution, the smooth rest on
// coarser levels (multilevel summation, Brandt and Lubrecht 1990; Hardy et al. 2009).
#pragma once

#include "item3d/core/math.h"
#include "item3d/render/kernels/cube_planes.h"

#include <cmath>
#include <cstdint>
#include <type_traits>

namespace item3d::kernels {

/// A kernel of the squared chord d = 2 (1 - n.l), so that narrow lobes keep their digits:
///   k(d) = max(0, profile(d) - floor), or within a cap d < inner the parabola `inner_cap`,
///          less the parabola `outer_cap`; 0 from `outer` on.
/// profile is GGX times the cosine, and falls with d. The caps cut a kernel into a narrow
/// part for a fine grid and a smooth rest for a coarser one.
struct ZonalKernel {
    bool cosine;   ///< k = |n.l| instead
    float alpha2;  ///< GGX: alpha^2
    float floor;   ///< profile at the lobe's edge, so that the kernel ends without a step
    float inner;
    float inner_cap[3];  ///< coefficients of 1, d, d^2
    float outer;
    float outer_cap[3];

    /// Real: float, or lanes of them.
    template <typename Real>
    [[gnu::always_inline]] Real profile(Real d) const {
        const Real c = 1 - 0.5f * d;
        const Real q = alpha2 + 0.25f * (1 - alpha2) * d;  // (n.h)^2 = 1 - d / 4
        return c / (q * q);
    }
    template <typename Real>
    [[gnu::always_inline]] Real value(Real d) const {
        const Real above = profile(d) - floor;
        const Real kernel = above > 0 ? above : Real{};
        const Real cap = inner_cap[0] + d * (inner_cap[1] + d * inner_cap[2]);
        const Real rest = outer_cap[0] + d * (outer_cap[1] + d * outer_cap[2]);
        return d < outer ? (d < inner ? cap : kernel) - rest : Real{};
    }
    /// Half angle of the cone outside which k = 0.
    float reach() const {
        const float sine = 0.5f * std::sqrt(outer);
        return 2 * std::asin(sine < 1 ? sine : 1.0f);
    }
};

/// Half-open range of texels of a face whose coordinate can be within a cone. along, normal: the
/// cone axis' components along that coordinate and the face's normal; sine: of the cone's half
/// angle.
struct TexelRange {
    int begin, end;
};
inline TexelRange cone_range(float along, float normal, float sine, int size) {
    const float length2 = along * along + normal * normal;
    if (length2 <= sine * sine * 1.0001f) return {0, size};
    // The axis in the plane of both, turned by the angle that the cone covers there to both sides.
    const float turn_sine = sine / std::sqrt(length2);
    const float turn_cosine = std::sqrt(1 - turn_sine * turn_sine);
    const float low_normal = normal * turn_cosine + along * turn_sine;
    const float low_along = along * turn_cosine - normal * turn_sine;
    const float high_normal = normal * turn_cosine - along * turn_sine;
    const float high_along = along * turn_cosine + normal * turn_sine;
    float low = -1, high = 1;
    if (low_normal > 0)
        low = low_along / low_normal;
    else if (along >= 0)
        return {0, 0};
    if (high_normal > 0)
        high = high_along / high_normal;
    else if (along <= 0)
        return {0, 0};
    if (low > 1 || high < -1) return {0, 0};
    low = low < -1 ? -1.0f : low;
    high = high > 1 ? 1.0f : high;
    // Texels whose centre is inside, and a hundredth of a texel more.
    const int begin = static_cast<int>((low + 1) * 0.5f * size + 0.49f);
    const int end = static_cast<int>((high + 1) * 0.5f * size + 0.51f);
    return {begin, end > size ? size : end};
}

/// Whether a lane is below the limit (1) or none (0).
template <int N>
[[gnu::always_inline]] inline int any_below(const Lanes<N>& lanes, float limit) {
    const auto below = lanes < limit;
    std::int64_t pairs[N / 2];
    __builtin_memcpy(pairs, &below, sizeof pairs);
    std::int64_t any = 0;
    for (const std::int64_t pair : pairs)
        any |= pair;
    return any != 0;
}

/// Sums of a kernel that reaches few texels, at the resolution of its source.
struct NearParameters {
    ZonalKernel kernel;
    const float* directions;       ///< [3, ..] planes with halos: of face 0's texels, unit
    std::int64_t direction_plane;  ///< floats from one of them to the next
    const float* source;           ///< CubePlanes: texel (0, 0), halo filled
    std::int64_t row_step, plane_step;
    int size, planes;
    float sine;           ///< of the kernel's half angle
    const float* coarse;  ///< CubePlanes of half the size, upsampled and added; null: none
    std::int64_t coarse_row, coarse_plane;
};

/// Two rows of all planes, one above the other mirrored at a face's middle.
struct NearSums {
    float rows[2][19][row_tile];
};

/// The texels within reach of N adjacent ones of a row, relative to the first of these.
template <int N>
struct NearTaps {
    static constexpr int halo = CubePlanes::halo, most = (2 * halo + 1) * (2 * halo + 1);
    int count;
    Lanes<N> weight[most];
    /// In a plane, and for the row that is mirrored at the face's middle.
    std::int32_t place[most], mirrored[most];
};

/// Where those of texels [x, x + lanes) can lie: rows and columns from the first on.
struct NearWindow {
    TexelRange rows, columns;
};
inline NearWindow near_window(const NearParameters& p, int row, int x, int lanes) {
    constexpr int halo = CubePlanes::halo;
    NearWindow window{{halo, -halo}, {halo, -halo}};
    for (const int end : {x, x + lanes - 1}) {
        const float s = texel_centre(end, p.size), t = texel_centre(row, p.size);
        const float length = 1 / std::sqrt(1 + s * s + t * t);
        const auto extend = [&](TexelRange& range, float along, int at) {
            const TexelRange face = cone_range(along * length, length, p.sine, p.size);
            range.begin = std::min(range.begin, face.begin > 0 ? face.begin - at : -halo);
            range.end = std::max(range.end, face.end < p.size ? face.end - at : halo + 1);
        };
        extend(window.rows, t, row);
        extend(window.columns, s, end);
    }
    for (TexelRange* range : {&window.rows, &window.columns})
        *range = {std::max(range->begin, -halo), std::min(range->end, halo + 1)};
    return window;
}

template <int N>
[[gnu::always_inline]] inline void near_taps(const NearParameters& p, int row, int x,
                                             NearTaps<N>& taps) {
    const NearWindow window = near_window(p, row, x, N);
    // A copy: the compiler makes vectors of the lanes only if nothing there can be aliased.
    const ZonalKernel kernel = p.kernel;
    const float* centre = p.directions + row * p.row_step + x;
    const std::int64_t plane = p.direction_plane;
    const Lanes<N> n[3] = {load_lanes<N>(centre), load_lanes<N>(centre + plane),
                           load_lanes<N>(centre + 2 * plane)};
    int count = 0;
    for (int dy = window.rows.begin; dy < window.rows.end; ++dy) {
        for (int dx = window.columns.begin; dx < window.columns.end; ++dx) {
            const float* tap = centre + dy * p.row_step + dx;
            const Lanes<N> a = n[0] - load_lanes<N>(tap);
            const Lanes<N> b = n[1] - load_lanes<N>(tap + plane);
            const Lanes<N> c = n[2] - load_lanes<N>(tap + 2 * plane);
            const Lanes<N> d = a * a + b * b + c * c;
            taps.weight[count] = kernel.value(d);
            taps.place[count] = static_cast<std::int32_t>(dy * p.row_step + dx);
            taps.mirrored[count] = static_cast<std::int32_t>(-dy * p.row_step + dx);
            count += any_below<N>(d, kernel.outer);
        }
    }
    taps.count = count;
}

/// Adds the sums of Count planes from one on, at N texels of both rows. The lanes are adjacent
/// texels: they share the taps' places, and all faces and both rows share the weights.
template <int N, int Count>
[[gnu::always_inline]] inline void add_near(const NearTaps<N>& taps, const float* upper,
                                            const float* lower, std::int64_t plane_step,
                                            float* upper_sums, float* lower_sums) {
    Lanes<N> above[Count], below[Count];
    for (int c = 0; c < Count; ++c) {
        above[c] = load_lanes<N>(upper_sums + c * row_tile);
        below[c] = load_lanes<N>(lower_sums + c * row_tile);
    }
    for (int i = 0; i < taps.count; ++i) {
        const Lanes<N> weight = taps.weight[i];
        const float *up = upper + taps.place[i], *down = lower + taps.mirrored[i];
#pragma GCC unroll 4
        for (int c = 0; c < Count; ++c) {
            above[c] += weight * load_lanes<N>(up + c * plane_step);
            below[c] += weight * load_lanes<N>(down + c * plane_step);
        }
    }
    for (int c = 0; c < Count; ++c) {
        store_lanes<N>(upper_sums + c * row_tile, above[c]);
        store_lanes<N>(lower_sums + c * row_tile, below[c]);
    }
}

/// Texels [column, column + row_tile) of the rows `row` and S - 1 - row.
template <int N>
[[gnu::always_inline]] inline void near_sums(const NearParameters& p, int row, int column,
                                             NearSums& sums) {
    const int rows[2] = {row, p.size - 1 - row};
    for (int half = 0; half < 2; ++half)
        for (int plane = 0; plane < p.planes; ++plane) {
            float* out = sums.rows[half][plane];
            if (p.coarse != nullptr)
                upsample_row(p.coarse + plane * p.coarse_plane, p.coarse_row, rows[half], column,
                             out);
            else
                std::fill_n(out, row_tile, 0.0f);
        }
    constexpr int groups = row_tile / N;
    NearTaps<N> taps[groups];
    for (int group = 0; group < groups; ++group)
        near_taps<N>(p, row, column + group * N, taps[group]);
    const float* upper = p.source + rows[0] * p.row_step + column;
    const float* lower = p.source + rows[1] * p.row_step + column;
    const auto add = [&]<int Count>(std::integral_constant<int, Count>, int plane) {
        for (int group = 0; group < row_tile; group += N)
            add_near<N, Count>(taps[group / N], upper + plane * p.plane_step + group,
                               lower + plane * p.plane_step + group, p.plane_step,
                               sums.rows[0][plane] + group, sums.rows[1][plane] + group);
    };
    // Few planes at a time, whose neighbourhood stays in the first cache while all groups read it;
    // four, so that no sum waits for its last.
    for (int plane = 0; plane < 16; plane += 4)
        add(std::integral_constant<int, 4>{}, plane);
    if (p.planes == 19)
        add(std::integral_constant<int, 3>{}, 16);
    else
        add(std::integral_constant<int, 2>{}, 16);
}

/// Sums of a kernel of any reach between maps of any sizes.
struct FarParameters {
    ZonalKernel kernel;
    /// Planes of [6 * S, S], rows and planes padded: three of the map, turned for each face of the
    /// output so that this face becomes face 0 (see turned_face), and perhaps the shared one. The
    /// kernel's values are then those of all six.
    const float* source;
    int source_size;  ///< S, a multiple of 16
    int planes;       ///< at most 19
    float* out;       ///< CubePlanes: texel (0, 0)
    std::int64_t out_row, out_plane;
    int out_size;                  ///< R
    const float* centres;          ///< [S] texel_centre(i, S)
    const float* inverse_lengths;  ///< [S, S] of the texels' directions on a face
    float sine;                    ///< of the kernel's half angle, at most 1
    float face_cut;  ///< faces whose centre is farther from n (cosine) are out of reach
};

/// How the texels of a face lie when the cube is turned so that face `to` becomes face 0.
struct TurnedFace {
    int face;  ///< where the texels come from
    /// The source's index by a column and by a row of the turned face, and at its texel (0, 0).
    std::int64_t column_step, row_step, first;
};
/// row: floats from a row of the source to the next.
inline TurnedFace turned_face(int to, int face, int size, std::int64_t row) {
    const CubeFrame from = cube_frame(0), target = cube_frame(to), turned = cube_frame(face);
    const auto turn = [&](Vec3 d) {
        return glm::dot(from.s, d) * target.s + glm::dot(from.t, d) * target.t +
               glm::dot(from.normal, d) * target.normal;
    };
    const Vec3 s = turn(turned.s), t = turn(turned.t), normal = turn(turned.normal);
    const int source = cube_face(normal);
    const CubeFrame frame = cube_frame(source);
    // Each of these is -1, 0 or 1: the source's s and t by the turned face's.
    const auto whole = [](float value) { return value > 0.5f ? 1 : (value < -0.5f ? -1 : 0); };
    const int ss = whole(glm::dot(frame.s, s)), st = whole(glm::dot(frame.s, t));
    const int ts = whole(glm::dot(frame.t, s)), tt = whole(glm::dot(frame.t, t));
    const int first_column = ss + st < 0 ? size - 1 : 0, first_row = ts + tt < 0 ? size - 1 : 0;
    return {source, ss + ts * row, st + tt * row, first_row * row + first_column};
}

/// Floats from a row to the next, and from a plane to the next, of FarParameters::source: sizes are
/// powers of two, and without padding all rows and planes would compete for the same lines of the
/// cache.
inline std::int64_t far_row(int size) {
    return size + 16;
}
inline std::int64_t far_plane(int size) {
    return 6 * size * far_row(size) + 48;
}

/// Kernel values of a few rows of texels, and what they weigh, for all planes of the output.
template <int N>
struct FarBatch {
    static constexpr int most_weights = 4096, most_rows = 128;
    Lanes<N> weights[most_weights / N];
    std::int64_t first[most_rows];  ///< index into a plane
    int groups[most_rows];          ///< of lanes
    int rows = 0, used = 0;
    Lanes<N> sums[19] = {};  ///< a sum for every N-th texel

    /// Count planes from `plane` on, so many that none waits for its last sum.
    template <int Count>
    [[gnu::always_inline]] void add(const FarParameters& p, int plane) {
        const std::int64_t step = far_plane(p.source_size);
        const float* source = p.source + plane * step;
        Lanes<N> sum[Count];
        for (int i = 0; i < Count; ++i)
            sum[i] = sums[plane + i];
        const Lanes<N>* k = weights;
        for (int row = 0; row < rows; ++row) {
            const float* values = source + first[row];
            for (int group = 0; group < groups[row]; ++group, ++k, values += N)
#pragma GCC unroll 9
                for (int i = 0; i < Count; ++i)
                    sum[i] += *k * load_lanes<N>(values + i * step);
        }
        for (int i = 0; i < Count; ++i)
            sums[plane + i] = sum[i];
    }
    [[gnu::always_inline]] void add(const FarParameters& p) {
        int plane = 0;
        for (; plane + 9 <= p.planes; plane += 9)
            add<9>(p, plane);
        if (plane < p.planes) add<1>(p, plane);
        rows = used = 0;
    }
};

/// One texel of all faces of the output; index: row * R + column. Rows and tables have a multiple
/// of N texels, and those outside the cone add nothing, so ranges are rounded out to whole groups
/// of lanes. AbsoluteCosine: k = |n.l| over the faces 0, 2 and 4 alone.
template <int N, bool AbsoluteCosine>
[[gnu::always_inline]] inline void far_sums(const FarParameters& p, std::int64_t index) {
    const int out_row = static_cast<int>(index / p.out_size);
    const int out_column = static_cast<int>(index % p.out_size);
    const Vec3 n = glm::normalize(
        cube_direction(0, texel_centre(out_column, p.out_size), texel_centre(out_row, p.out_size)));
    const int size = p.source_size;
    const ZonalKernel kernel = p.kernel;
    FarBatch<N> batch;
    for (int face = 0; face < 6; face += AbsoluteCosine ? 2 : 1) {
        const CubeFrame frame = cube_frame(face);
        const float normal = glm::dot(frame.normal, n);
        if (!AbsoluteCosine && normal < p.face_cut) continue;
        const float along_s = glm::dot(frame.s, n), along_t = glm::dot(frame.t, n);
        const TexelRange all{0, size};
        const TexelRange rows = AbsoluteCosine ? all : cone_range(along_t, normal, p.sine, size);
        if (rows.begin >= rows.end) continue;
        const TexelRange columns = AbsoluteCosine ? all : cone_range(along_s, normal, p.sine, size);
        if (columns.begin >= columns.end) continue;
        const int first = columns.begin / N * N;
        const int groups = (columns.end - first + N - 1) / N;
        for (int row = rows.begin; row < rows.end; ++row) {
            if (batch.rows == FarBatch<N>::most_rows ||
                N * (batch.used + groups) > FarBatch<N>::most_weights)
                batch.add(p);
            const float rest = along_t * p.centres[row] + normal;
            const float* lengths = p.inverse_lengths + row * size + first;
            const float* centres = p.centres + first;
            for (int i = 0; i < groups; ++i) {
                const Lanes<N> c = (along_s * load_lanes<N>(centres + i * N) + rest) *
                                   load_lanes<N>(lengths + i * N);
                if constexpr (AbsoluteCosine)
                    batch.weights[batch.used++] = c < 0 ? -c : c;
                else
                    batch.weights[batch.used++] = kernel.value(2 - 2 * c);
            }
            batch.first[batch.rows] = (face * size + row) * far_row(size) + first;
            batch.groups[batch.rows++] = groups;
        }
    }
    batch.add(p);
    float* out = p.out + out_row * p.out_row + out_column;
    for (int plane = 0; plane < p.planes; ++plane) {
        float lanes[N], sum = 0;
        store_lanes<N>(lanes, batch.sums[plane]);
        for (const float lane : lanes)
            sum += lane;
        out[plane * p.out_plane] = sum;
    }
}

}  // namespace item3d::kernels
