// Zonal kernels on the sphere. They are weighted sums out(n) = sum_l k(n.l) f(l), whose weight
// depends only on the angle between two directions. f is the radiance times the solid angle of a
// texel.
//
// Prefiltering for n = v = r (Karis 2013) multiplies the radiance from l by D(h) (n.l). For n = v,
// (n.h)^2 = (1 + n.l) / 2, so GGX becomes such a zonal kernel. An output texel is a sum over the
// input texels within the kernel's reach. The kernel is symmetric, so the transpose is a sum of the
// same kind.
//
// Direct sums over N texels have N^2 terms. Wide lobes on fine maps are summed over a pyramid
// (multilevel summation, Brandt and Lubrecht 1990; Hardy et al. 2009): k = near + rest, where near
// is 0 beyond a few texels, and rest is smooth enough for half the resolution,
//
//     K f ~ Near f + U Rest (U^T f)        K, Near, Rest: matrices of the kernels
//                                          U: upsampling of cube_planes.h
//
// The same split is repeated for `rest` on the coarser levels, down to a map of a fixed size. The
// cost is N times the number of near texels, and a third more for all coarser levels
// (docs/kernels.md).
//
//     directions  [3, size + 16, size + 16] of face 0 and its halo: all faces have these angles
//     turned      [3 faces (+ 1), 6, size, size + 16] (+ 48 a plane): the map as each face sees it
//
// This file has the sums of one texel, for a device's thread; zonal_lanes.h has those of several
// texels at once, for a processor's vectors.
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube_planes.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

inline constexpr int max_planes = 19;

/// A kernel over the squared chord d = 2 (1 - n.l), which keeps the precision of narrow lobes:
///   k(d) = max(0, profile(d) - floor), or within a cap d < inner the parabola `inner_cap`,
///          less the parabola `outer_cap`; 0 from `outer` on.
///
/// profile is GGX times the cosine, and decreases with d. The caps split a kernel into a narrow
/// part for a fine grid and a smooth rest for a coarser one.
struct ZonalKernel {
    bool cosine;         ///< true for the kernel k = |n.l| instead
    float alpha2;        ///< GGX: alpha^2
    float floor;         ///< profile at the lobe's edge, so that the kernel is continuous
    float inner = -1;    ///< negative: no cap, whatever rounding makes of a chord of 0
    float inner_cap[3];  ///< coefficients of 1, d, d^2
    float outer;
    float outer_cap[3];

    /// Returns profile(d). Real: float, or a vector of floats.
    template <typename Real>
    ITEM3D_HOST_DEVICE ITEM3D_ALWAYS_INLINE Real profile(Real d) const {
        const Real c = 1 - 0.5f * d;
        const Real q = alpha2 + 0.25f * (1 - alpha2) * d;  // (n.h)^2 = 1 - d / 4
        return c / (q * q);
    }
    template <typename Real>
    ITEM3D_HOST_DEVICE ITEM3D_ALWAYS_INLINE Real value(Real d) const {
        const Real above = profile(d) - floor;
        const Real kernel = above > 0 ? above : Real{};
        const Real cap = inner_cap[0] + d * (inner_cap[1] + d * inner_cap[2]);
        const Real rest = outer_cap[0] + d * (outer_cap[1] + d * outer_cap[2]);
        return d < outer ? (d < inner ? cap : kernel) - rest : Real{};
    }
    /// Returns the half angle of the cone outside which k = 0.
    ITEM3D_HOST_DEVICE float reach() const {
        const float sine = 0.5f * std::sqrt(outer);
        return 2 * std::asin(sine < 1 ? sine : 1.0f);
    }
};

/// Half-open range of texels of a face whose coordinate can be within a cone. along, normal:
/// components of the cone's axis along that coordinate and along the face's normal. sine: sine of
/// the cone's half angle.
struct TexelRange {
    int begin, end;
};
ITEM3D_HOST_DEVICE inline TexelRange cone_range(float along, float normal, float sine, int size) {
    const float length2 = along * along + normal * normal;
    if (length2 <= sine * sine * 1.0001f) return {0, size};
    // The axis is projected onto the plane of the coordinate and the normal. It is then turned to
    // both sides by the cone's angle in that plane.
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
    // The range has the texels whose centre is inside, with a tolerance of a hundredth of a texel.
    const int begin = static_cast<int>((low + 1) * 0.5f * size + 0.49f);
    const int end = static_cast<int>((high + 1) * 0.5f * size + 0.51f);
    return {begin, end > size ? size : end};
}

/// Parameters of the unit directions of face 0's texels and halo.
struct DirectionParameters {
    float* directions;  ///< [3, S + 2 halo, S + 2 halo]
    int size;
};

/// Writes the direction of a texel. index: the texel's index, with the halo included.
ITEM3D_HOST_DEVICE inline void halo_texel_direction(const DirectionParameters& p,
                                                    std::int64_t index) {
    constexpr int halo = Planes::halo;
    const int size = p.size;
    const std::int64_t row = size + 2 * halo;
    const int x = static_cast<int>(index % row) - halo, y = static_cast<int>(index / row) - halo;
    const bool off_x = x < 0 || x >= size, off_y = y < 0 || y >= size;
    Vec3 d(0.0f);  // beyond the reach of near texels
    if (off_x && !off_y)
        d = halo_direction(0, x < 0 ? 0 : 1, y, x < 0 ? -x : x - size + 1, size);
    else if (off_y && !off_x)
        d = halo_direction(0, y < 0 ? 2 : 3, x, y < 0 ? -y : y - size + 1, size);
    else if (!off_x)
        d = cube_direction(0, texel_centre(x, size), texel_centre(y, size));
    if (!(off_x && off_y)) d = glm::normalize(d);
    for (int c = 0; c < 3; ++c)
        p.directions[c * row * row + index] = d[c];
}

/// Parameters of sums whose kernel reaches few texels, at the source's resolution.
struct NearParameters {
    ZonalKernel kernel;
    const float* directions;       ///< [3, ..] planes with halos: unit directions of face 0
    std::int64_t direction_plane;  ///< floats between two of these planes
    ConstPlanes source;            ///< planes with a filled halo
    float sine;                    ///< sine of the kernel's half angle
    Planes out;                    ///< planes to which sums are added; unused by zonal_lanes.h
};

/// Window of the texels within reach of the texels [x, x + lanes), as offsets of rows and columns.
struct NearWindow {
    TexelRange rows, columns;
};
ITEM3D_HOST_DEVICE inline NearWindow near_window(const NearParameters& p, int row, int x,
                                                 int lanes) {
    constexpr int halo = Planes::halo;
    const int size = p.source.size;
    NearWindow window{{halo, -halo}, {halo, -halo}};
    for (int i = 0; i < 2; ++i) {
        const int end = i == 0 ? x : x + lanes - 1;
        const float s = texel_centre(end, size), t = texel_centre(row, size);
        const float length = 1 / std::sqrt(1 + s * s + t * t);
        const auto extend = [&](TexelRange& range, float along, int at) {
            const TexelRange face = cone_range(along * length, length, p.sine, size);
            const int begin = face.begin > 0 ? face.begin - at : -halo;
            const int after = face.end < size ? face.end - at : halo + 1;
            if (begin < range.begin) range.begin = begin;
            if (after > range.end) range.end = after;
        };
        extend(window.rows, t, row);
        extend(window.columns, s, end);
    }
    const auto inside = [](const TexelRange& range) {
        return TexelRange{range.begin > -halo ? range.begin : -halo,
                          range.end < halo + 1 ? range.end : halo + 1};
    };
    return {inside(window.rows), inside(window.columns)};
}

/// Adds the sums at one texel of all planes. index: row * S + column.
ITEM3D_HOST_DEVICE inline void add_near_sums(const NearParameters& p, std::int64_t index) {
    const int size = p.source.size;
    const int row = static_cast<int>(index / size), column = static_cast<int>(index % size);
    const NearWindow window = near_window(p, row, column, 1);
    const std::int64_t row_step = p.source.row_step(), plane_step = p.source.plane_step();
    const auto direction = [&](std::int64_t place) {
        const float* at = p.directions + place;
        return Vec3(at[0], at[p.direction_plane], at[2 * p.direction_plane]);
    };
    const std::int64_t centre = row * row_step + column;
    const Vec3 n = direction(centre);
    float sums[max_planes] = {};
    for (int dy = window.rows.begin; dy < window.rows.end; ++dy)
        for (int dx = window.columns.begin; dx < window.columns.end; ++dx) {
            const std::int64_t place = centre + dy * row_step + dx;
            const Vec3 chord = n - direction(place);
            const float d = glm::dot(chord, chord);
            if (!(d < p.kernel.outer)) continue;
            const float weight = p.kernel.value(d);
            for (int plane = 0; plane < max_planes; ++plane)
                if (plane < p.source.count)
                    sums[plane] += weight * p.source.values[plane * plane_step + place];
        }
    for (int plane = 0; plane < max_planes; ++plane)
        if (plane < p.source.count) p.out.row(plane, row)[column] += sums[plane];
}

/// Parameters of sums with a kernel of any reach, between maps of any sizes.
struct FarParameters {
    ZonalKernel kernel;
    /// Turned planes of the map (TurnParameters). With them, the kernel's values serve all faces of
    /// the output.
    const float* source;
    int source_size;  ///< S, a multiple of 16
    int planes;       ///< at most 19
    Planes out;
    const float* centres;          ///< [S] texel_centre(i, S)
    const float* inverse_lengths;  ///< [S, S] of the texels' directions on a face
    float sine;                    ///< sine of the kernel's half angle, at most 1
    float face_cut;  ///< smallest cosine between n and the centre of a face within reach
};

/// Layout of a face's texels after a rotation of the cube that makes face `to` face 0.
struct TurnedFace {
    int face;  ///< source of the texels
    /// Steps of the source's index for a column and a row of the turned face, and index of texel
    /// (0, 0).
    std::int64_t column_step, row_step, first;
};
/// Returns the layout of a face. row: number of floats between rows of the source.
ITEM3D_HOST_DEVICE inline TurnedFace turned_face(int to, int face, int size, std::int64_t row) {
    const CubeFrame from = cube_frame(0), target = cube_frame(to), turned = cube_frame(face);
    const auto turn = [&](Vec3 d) {
        return glm::dot(from.s, d) * target.s + glm::dot(from.t, d) * target.t +
               glm::dot(from.normal, d) * target.normal;
    };
    const Vec3 s = turn(turned.s), t = turn(turned.t), normal = turn(turned.normal);
    const int source = cube_face(normal);
    const CubeFrame frame = cube_frame(source);
    // Derivatives, -1, 0 or 1, of the source's s and t with respect to the turned face's.
    const auto whole = [](float value) { return value > 0.5f ? 1 : (value < -0.5f ? -1 : 0); };
    const int ss = whole(glm::dot(frame.s, s)), st = whole(glm::dot(frame.s, t));
    const int ts = whole(glm::dot(frame.t, s)), tt = whole(glm::dot(frame.t, t));
    const int first_column = ss + st < 0 ? size - 1 : 0, first_row = ts + tt < 0 ? size - 1 : 0;
    return {source, ss + ts * row, st + tt * row, first_row * row + first_column};
}

/// Returns the floats between rows (far_row) and planes (far_plane) of FarParameters::source. Sizes
/// are powers of two, and without padding all rows and planes would map to the same lines of the
/// cache.
ITEM3D_HOST_DEVICE inline std::int64_t far_row(int size) {
    return size + 16;
}
ITEM3D_HOST_DEVICE inline std::int64_t far_plane(int size) {
    return 6 * size * far_row(size) + 48;
}

struct TurnParameters {
    ConstPlanes map;
    float* turned;  ///< FarParameters::source
    int faces;      ///< faces of the output, 6 or 3: in steps of 6 / faces
    int length;
};

/// Copies a run of a row to `turned`. index: number of the run, counted over the six faces of each
/// plane of `turned`.
ITEM3D_HOST_DEVICE inline void turn_planes(const TurnParameters& p, std::int64_t index) {
    const int size = p.map.size;
    const Run run = run_of(index, size, p.length);
    const int plane = run.plane / 6, face = run.plane % 6;
    const bool shared = plane == 3 * p.faces;
    const TurnedFace from =
        turned_face(shared ? 0 : plane / 3 * (6 / p.faces), face, size, p.map.row_step());
    const float* in = p.map.row(shared ? 18 : 3 * from.face + plane % 3, 0) + from.first +
                      run.row * from.row_step;
    float* out = p.turned + plane * far_plane(size) + (face * size + run.row) * far_row(size);
    for (int x = run.begin; x < run.end; ++x)
        out[x] = in[x * from.column_step];
}

/// Part of a face within reach of an output texel's direction n.
struct FaceReach {
    float along_s, along_t, normal;  ///< n in the face's frame
    TexelRange rows, columns;
};
/// Returns the part within reach. Its rows are empty if no part is within reach. AbsoluteCosine:
/// true if the whole face is within reach.
template <bool AbsoluteCosine>
ITEM3D_HOST_DEVICE ITEM3D_ALWAYS_INLINE inline FaceReach face_reach(const FarParameters& p,
                                                                    int face, Vec3 n) {
    const CubeFrame frame = cube_frame(face);
    const TexelRange all{0, p.source_size}, none{0, 0};
    FaceReach reach{glm::dot(frame.s, n), glm::dot(frame.t, n), glm::dot(frame.normal, n), all,
                    all};
    if (AbsoluteCosine) return reach;
    reach.rows = reach.normal < p.face_cut
                     ? none
                     : cone_range(reach.along_t, reach.normal, p.sine, p.source_size);
    if (reach.rows.begin < reach.rows.end)
        reach.columns = cone_range(reach.along_s, reach.normal, p.sine, p.source_size);
    return reach;
}

/// Sums one texel for all faces of the output. index: row * R + column. AbsoluteCosine: true for k
/// = |n.l| over the faces 0, 2 and 4 only.
template <bool AbsoluteCosine>
ITEM3D_HOST_DEVICE inline void far_sums_of_texel(const FarParameters& p, std::int64_t index) {
    const int out_row = static_cast<int>(index / p.out.size);
    const int out_column = static_cast<int>(index % p.out.size);
    const Vec3 n = unit_direction(0, out_row, out_column, p.out.size);
    const int size = p.source_size;
    const std::int64_t step = far_plane(size);
    float sums[max_planes] = {};
    for (int face = 0; face < 6; face += AbsoluteCosine ? 2 : 1) {
        const FaceReach reach = face_reach<AbsoluteCosine>(p, face, n);
        for (int row = reach.rows.begin; row < reach.rows.end; ++row) {
            const float rest = reach.along_t * p.centres[row] + reach.normal;
            const float* values = p.source + (face * size + row) * far_row(size);
            for (int column = reach.columns.begin; column < reach.columns.end; ++column) {
                const float c = (reach.along_s * p.centres[column] + rest) *
                                p.inverse_lengths[row * size + column];
                const float weight = AbsoluteCosine ? std::fabs(c) : p.kernel.value(2 - 2 * c);
                for (int plane = 0; plane < max_planes; ++plane)
                    if (plane < p.planes) sums[plane] += weight * values[plane * step + column];
            }
        }
    }
    for (int plane = 0; plane < max_planes; ++plane)
        if (plane < p.planes) p.out.row(plane, out_row)[out_column] = sums[plane];
}

}  // namespace item3d::kernels
