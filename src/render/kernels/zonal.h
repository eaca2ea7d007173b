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

    template <bool Cosine>
    ITEM3D_HOST_DEVICE float profile(float c) const {
        if constexpr (Cosine) return c;
        const float d = 0.5f * (1 + c) * alpha2_1 + 1;
        return c / (d * d);
    }
    template <bool Cosine>
    ITEM3D_HOST_DEVICE float value(float c) const {
        if constexpr (Cosine) return c > 0 ? c : 0.0f;
        const float d = 2 - 2 * c;
        const float above = profile<Cosine>(c) - floor;
        const float kernel = above > 0 ? above : 0.0f;
        const float cap = inner_cap[0] + d * (inner_cap[1] + d * inner_cap[2]);
        const float rest = outer_cap[0] + d * (outer_cap[1] + d * outer_cap[2]);
        return d < outer ? (d < inner ? cap : kernel) - rest : 0.0f;
    }
    /// Half angle of the cone outside which k = 0.
    ITEM3D_HOST_DEVICE float reach() const {
        const float sine = 0.5f * std::sqrt(outer);
        return 2 * std::asin(sine < 1 ? sine : 1.0f);
    }
};

struct ZonalParameters {
    ZonalKernel kernel;
    const float* source;           ///< [4, 6, S, S] planes
    int source_size;               ///< S
    float* out;                    ///< [6, R, R, 4]: sums over the source of k times each plane
    int out_size;                  ///< R
    const float* centres;          ///< [S] texel_centre(i, S)
    const float* inverse_lengths;  ///< [S, S] of the texels\' directions on a face
};

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
    int begin = static_cast<int>(std::floor((low + 1) * 0.5f * size - 0.51f));
    int end = static_cast<int>(std::ceil((high + 1) * 0.5f * size - 0.49f)) + 1;
    begin = begin < 0 ? 0 : begin;
    end = end > size ? size : end;
    return {begin, end};
}

inline constexpr int zonal_lanes = 8;

/// Sums over every eighth texel, so that rows need no sum across lanes.
struct ZonalSums {
    float lane[4][zonal_lanes] = {};
};

/// One row of texels of a face. The planes' and the tables' rows have a multiple of eight texels;
/// those outside the cone add nothing, so a range may be rounded out to whole groups of lanes.
struct ZonalRow {
    const float* centres;
    const float* inverse_lengths;
    const float* planes[4];
    float along, rest;  ///< n.l = (along * centre + rest) * inverse_length
    int begin, end;
};
template <bool Cosine>
[[gnu::always_inline]] ITEM3D_HOST_DEVICE inline void zonal_row(const ZonalKernel& kernel_,
                                                                const ZonalRow& row,
                                                                ZonalSums& sums) {
    // Copies: the compiler makes vectors of the lanes only if nothing there can be aliased.
    const ZonalKernel kernel = kernel_;
    const float along = row.along, rest = row.rest;
    for (int i = row.begin / zonal_lanes * zonal_lanes; i < row.end; i += zonal_lanes) {
        const float* centres = row.centres + i;
        const float* inverse_lengths = row.inverse_lengths + i;
        float k[zonal_lanes];
#pragma omp simd
        for (int lane = 0; lane < zonal_lanes; ++lane) {
            const float c = (along * centres[lane] + rest) * inverse_lengths[lane];
            k[lane] = kernel.value<Cosine>(c);
        }
        for (int plane = 0; plane < 4; ++plane) {
            const float* values = row.planes[plane] + i;
#pragma omp simd
            for (int lane = 0; lane < zonal_lanes; ++lane)
                sums.lane[plane][lane] += k[lane] * values[lane];
        }
    }
}

/// index: texel of the output. `add_row` is zonal_row, or a version of it for the processor at
/// hand.
template <typename AddRow>
ITEM3D_HOST_DEVICE inline void zonal_gather(const ZonalParameters& p, std::int64_t index,
                                            const AddRow& add_row) {
    const int out_face = static_cast<int>(index / (p.out_size * p.out_size));
    const int out_row = static_cast<int>(index / p.out_size % p.out_size);
    const int out_column = static_cast<int>(index % p.out_size);
    const Vec3 n = glm::normalize(cube_direction(out_face, texel_centre(out_column, p.out_size),
                                                 texel_centre(out_row, p.out_size)));
    const std::int64_t size = p.source_size, plane = 6 * size * size;
    const float reach = p.kernel.reach(), sine = std::sin(reach < 0.5f * pi ? reach : 0.5f * pi);
    // The corners of a face are 54.7 degrees off its centre.
    const float farthest = reach + 0.9554f;
    const float face_cut = farthest < pi ? std::cos(farthest) : -1.0f;
    ZonalSums sums;
    for (int face = 0; face < 6; ++face) {
        const CubeFrame frame = cube_frame(face);
        const float normal = glm::dot(frame.normal, n);
        if (normal < face_cut) continue;
        const float along_s = glm::dot(frame.s, n), along_t = glm::dot(frame.t, n);
        const TexelRange rows = cone_range(along_t, normal, sine, p.source_size);
        if (rows.begin >= rows.end) continue;
        const TexelRange columns = cone_range(along_s, normal, sine, p.source_size);
        ZonalRow line;
        line.centres = p.centres;
        line.along = along_s;
        line.begin = columns.begin;
        line.end = columns.end;
        for (int row = rows.begin; row < rows.end; ++row) {
            line.inverse_lengths = p.inverse_lengths + row * size;
            line.rest = along_t * p.centres[row] + normal;
            for (int c = 0; c < 4; ++c)
                line.planes[c] = p.source + c * plane + (face * size + row) * size;
            add_row(p.kernel, line, sums);
        }
    }
    for (int c = 0; c < 4; ++c) {
        float sum = 0;
        for (int lane = 0; lane < zonal_lanes; ++lane)
            sum += sums.lane[c][lane];
        p.out[4 * index + c] = sum;
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
