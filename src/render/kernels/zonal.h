// Convolution of a cube map with a kernel that depends on the angle between directions alone.
//
// Prefiltering for n = v = r (Karis 2013) weighs the radiance from l with D(h) (n.l), and there
// (n.h)^2 = (1 + n.l) / 2, so GGX becomes such a zonal kernel: the sum over all texels within reach
// can be written as a plain gather, and, the kernel being symmetric, so can its transpose. Wide
// lobes on fine maps are summed over a pyramid: near texels at full resolution, the smooth rest on
// coarser levels (multilevel summation, Brandt and Lubrecht 1990; Hardy et al. 2009).
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

inline constexpr int zonal_lanes = 8;
/// Written as a vector: the compiler does not make one of the kernel's selections by itself.
using Lanes = float __attribute__((vector_size(4 * zonal_lanes)));

[[gnu::always_inline]] inline Lanes load_lanes(const float* values) {
    Lanes lanes;
    __builtin_memcpy(&lanes, values, sizeof lanes);
    return lanes;
}

/// A kernel of c = n.l, written over d = 2 (1 - c), the squared chord:
///   k(d) = max(0, profile(c) - floor), or within a cap d < inner the parabola `inner_cap`,
///          less the parabola `outer_cap`; 0 from `outer` on.
/// profile is the cosine, or GGX times it, and grows with c. The caps cut a kernel into a narrow
/// part for a fine grid and a smooth rest for a coarser one.
struct ZonalKernel {
    bool cosine;     ///< profile(c) = c
    float alpha2_1;  ///< GGX: alpha^2 - 1
    float floor;     ///< profile at the lobe's edge, so that the kernel ends without a step
    float inner;
    float inner_cap[3];  ///< coefficients of 1, d, d^2
    float outer;
    float outer_cap[3];

    /// Real: float, or Lanes of them.
    template <bool Cosine, typename Real>
    [[gnu::always_inline]] Real profile(Real c) const {
        if constexpr (Cosine) return c;
        const Real d = 0.5f * (1 + c) * alpha2_1 + 1;
        return c / (d * d);
    }
    template <bool Cosine, typename Real>
    [[gnu::always_inline]] Real value(Real c) const {
        if constexpr (Cosine) return c > 0 ? c : Real{};
        const Real d = 2 - 2 * c;
        const Real above = profile<Cosine>(c) - floor;
        const Real kernel = above > 0 ? above : Real{};
        const Real cap = inner_cap[0] + d * (inner_cap[1] + d * inner_cap[2]);
        const Real rest = outer_cap[0] + d * (outer_cap[1] + d * outer_cap[2]);
        return d < outer ? (d < inner ? cap : kernel) - rest : Real{};
    }
    /// Half angle of the cone outside which k = 0.
    ITEM3D_HOST_DEVICE float reach() const {
        const float sine = 0.5f * std::sqrt(outer);
        return 2 * std::asin(sine < 1 ? sine : 1.0f);
    }
};

struct ZonalParameters {
    ZonalKernel kernel;
    /// [6, 4, 6 * S, S], rows and planes padded: four planes of the map, turned for each face of
    /// the output so that this face becomes face 0 (see turned_face). The kernel's values are then
    /// those of all six.
    const float* source;
    int source_size;               ///< S, a multiple of zonal_lanes
    float* out;                    ///< [6, R, R, 4]: sums over the source of k times each plane
    int out_size;                  ///< R
    const float* centres;          ///< [S] texel_centre(i, S)
    const float* inverse_lengths;  ///< [S, S] of the texels' directions on a face
    float sine;                    ///< of the kernel's half angle, at most 1
    float face_cut;  ///< faces whose centre is farther from n (cosine) are out of reach
};

/// How the texels of a face lie when the cube is turned so that face `to` becomes face 0.
struct TurnedFace {
    int face;                   ///< where the texels come from
    int column_step, row_step;  ///< the source's index by a column and by a row of the turned face
    int first;                  ///< the source's index at the turned face's texel (0, 0)
};
ITEM3D_HOST_DEVICE inline TurnedFace turned_face(int to, int face, int size) {
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
    return {source, ss + ts * size, st + tt * size, first_row * size + first_column};
}

/// Half-open range of texels of a face whose coordinate can be within a cone. along, normal: the
/// cone axis' components along that coordinate and the face's normal; sine: of the cone's half
/// angle.
struct TexelRange {
    int begin, end;
};
ITEM3D_HOST_DEVICE inline TexelRange cone_range(float along, float normal, float sine, int size) {
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
    // Truncation is floor() and ceil() here: what is below 0 is cut off.
    const int begin = static_cast<int>((low + 1) * 0.5f * size - 0.51f);
    const int end = static_cast<int>((high + 1) * 0.5f * size + 0.51f) + 1;
    return {begin < 0 ? 0 : begin, end > size ? size : end};
}

/// Floats from a row to the next, and from a plane to the next: sizes are powers of two, and
/// without padding all rows and planes would compete for the same lines of the cache.
inline std::int64_t zonal_row(int size) {
    return size + 16;
}
inline std::int64_t zonal_plane(int size) {
    return 6 * size * zonal_row(size) + 48;
}

/// Kernel values of a few rows of texels, and what they weigh, for all faces of the output.
struct ZonalBatch {
    static constexpr int most_weights = 4096, most_rows = 128;
    Lanes weights[most_weights / zonal_lanes];
    std::int64_t first[most_rows];  ///< index into a plane
    int groups[most_rows];          ///< of lanes
    int rows = 0, used = 0;
    Lanes sums[6][4] = {};  ///< a sum for every eighth texel

    [[gnu::always_inline]] void add(const ZonalParameters& p) {
        const std::int64_t plane = zonal_plane(p.source_size);
        for (int face = 0; face < 6; ++face) {
            const float* source = p.source + 4 * plane * face;
            Lanes a = sums[face][0], b = sums[face][1], c = sums[face][2], d = sums[face][3];
            const Lanes* k = weights;
            for (int row = 0; row < rows; ++row) {
                const float* values = source + first[row];
                for (int group = 0; group < groups[row]; ++group, ++k, values += zonal_lanes) {
                    a += *k * load_lanes(values);
                    b += *k * load_lanes(values + plane);
                    c += *k * load_lanes(values + 2 * plane);
                    d += *k * load_lanes(values + 3 * plane);
                }
            }
            sums[face][0] = a;
            sums[face][1] = b;
            sums[face][2] = c;
            sums[face][3] = d;
        }
        rows = used = 0;
    }
};

/// One texel of all faces of the output; index: row * R + column. Rows and tables have a multiple
/// of eight texels, and those outside the cone add nothing, so ranges are rounded out to whole
/// groups of lanes.
template <bool Cosine>
[[gnu::always_inline]] inline void zonal_gather(const ZonalParameters& p, std::int64_t index) {
    const Vec3 n = glm::normalize(
        cube_direction(0, texel_centre(static_cast<int>(index % p.out_size), p.out_size),
                       texel_centre(static_cast<int>(index / p.out_size), p.out_size)));
    const int size = p.source_size;
    // Copies: the compiler makes vectors of the lanes only if nothing there can be aliased.
    const ZonalKernel kernel = p.kernel;
    ZonalBatch batch;
    for (int face = 0; face < 6; ++face) {
        const CubeFrame frame = cube_frame(face);
        const float normal = glm::dot(frame.normal, n);
        if (normal < p.face_cut) continue;
        const float along_s = glm::dot(frame.s, n), along_t = glm::dot(frame.t, n);
        const TexelRange rows = cone_range(along_t, normal, p.sine, size);
        if (rows.begin >= rows.end) continue;
        const TexelRange columns = cone_range(along_s, normal, p.sine, size);
        if (columns.begin >= columns.end) continue;
        const int first = columns.begin / zonal_lanes * zonal_lanes;
        const int groups = (columns.end - first + zonal_lanes - 1) / zonal_lanes;
        for (int row = rows.begin; row < rows.end; ++row) {
            if (batch.rows == ZonalBatch::most_rows ||
                zonal_lanes * (batch.used + groups) > ZonalBatch::most_weights)
                batch.add(p);
            const float rest = along_t * p.centres[row] + normal;
            const float* lengths = p.inverse_lengths + row * size + first;
            const float* centres = p.centres + first;
            for (int i = 0; i < groups; ++i) {
                const Lanes c = (along_s * load_lanes(centres + i * zonal_lanes) + rest) *
                                load_lanes(lengths + i * zonal_lanes);
                batch.weights[batch.used++] = kernel.value<Cosine>(c);
            }
            batch.first[batch.rows] = (face * size + row) * zonal_row(size) + first;
            batch.groups[batch.rows++] = groups;
        }
    }
    batch.add(p);
    for (int face = 0; face < 6; ++face) {
        float* out =
            p.out + 4 * (face * static_cast<std::int64_t>(p.out_size) * p.out_size + index);
        for (int c = 0; c < 4; ++c) {
            float sum = 0;
            for (int lane = 0; lane < zonal_lanes; ++lane)
                sum += batch.sums[face][c][lane];
            out[c] = sum;
        }
    }
}

/// Twice as fine a map, bilinear and without seams. index: texel of out [6, 2R, 2R, 4].
ITEM3D_HOST_DEVICE inline void upsample_cube(const float* coarse, int coarse_size,
                                             std::int64_t index, float* out) {
    const int size = 2 * coarse_size;
    const int face = static_cast<int>(index / (size * size));
    const int row = static_cast<int>(index / size % size), column = static_cast<int>(index % size);
    const CubeTaps taps = cube_taps(
        cube_direction(face, texel_centre(column, size), texel_centre(row, size)), coarse_size);
    for (int c = 0; c < 4; ++c) {
        float sum = 0;
        for (int i = 0; i < 4; ++i)
            sum += taps.weight[i] * coarse[4 * static_cast<std::int64_t>(taps.texel[i]) + c];
        out[4 * index + c] = sum;
    }
}

/// The transpose of upsample_cube without the taps across edges. index: texel of
/// coarse_gradient [6, R, R, 4].
ITEM3D_HOST_DEVICE inline void upsample_cube_backward(const float* gradient, int coarse_size,
                                                      std::int64_t index, float* coarse_gradient) {
    const int size = 2 * coarse_size;
    const int face = static_cast<int>(index / (coarse_size * coarse_size));
    const int row = static_cast<int>(index / coarse_size % coarse_size);
    const int column = static_cast<int>(index % coarse_size);
    float sum[4] = {0, 0, 0, 0};
    for (int j = -1; j <= 2; ++j) {
        const int y = 2 * row + j;
        if (y < 0 || y >= size) continue;
        for (int i = -1; i <= 2; ++i) {
            const int x = 2 * column + i;
            if (x < 0 || x >= size) continue;
            const float weight =
                (i == 0 || i == 1 ? 0.75f : 0.25f) * (j == 0 || j == 1 ? 0.75f : 0.25f);
            const float* in =
                gradient + 4 * ((static_cast<std::int64_t>(face) * size + y) * size + x);
            for (int c = 0; c < 4; ++c)
                sum[c] += weight * in[c];
        }
    }
    for (int c = 0; c < 4; ++c)
        coarse_gradient[4 * index + c] = sum[c];
}

}  // namespace item3d::kernels
