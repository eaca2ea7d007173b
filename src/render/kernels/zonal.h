// Convolution of a cube map with a kernel that depends on the angle between directions alone.
//
// Prefiltering for n = v = r (Karis 2013) weighs the radiance from l with D(h) (n.l), and there
// (n.h)^2 = (1 + n.l) / 2, so GGX becomes such a zonal kernel: the sum over all texels within reach
// can be written as a plain gather, and, the kernel being symmetric, so can its transpose.
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

/// k(c) = max(0, profile(c) - floor) for c = n.l > cut, else 0; profile is the clamped cosine, or
/// GGX times it.
struct ZonalKernel {
    bool cosine;      ///< k(c) = c
    float alpha2_1;   ///< GGX: alpha^2 - 1
    float floor;      ///< profile(cut), so that the kernel ends without a step
    float cut;        ///< in [0, 1)
    float cut_angle;  ///< acos(cut)

    ITEM3D_HOST_DEVICE float profile(float c) const {
        if (cosine) return c;
        const float d = 0.5f * (1 + c) * alpha2_1 + 1;
        return c / (d * d);
    }
};

struct ZonalParameters {
    ZonalKernel kernel;
    const float* source;   ///< [4, 6, S, S] planes
    int source_size;       ///< S
    float* out;            ///< [6, R, R, 4]: sums over the source of k times each plane
    int out_size;          ///< R
    const float* centres;  ///< [S] texel_centre(i, S)
};

/// Half-open range of texels of a face whose coordinate along `axis` can be within the cone.
/// along, normal: the cone axis' components; sine: of the cone's half angle (below 90 degrees).
struct TexelRange {
    int begin, end;
};
ITEM3D_HOST_DEVICE inline TexelRange cone_range(float along, float normal, float sine, int size) {
    const float length = std::sqrt(along * along + normal * normal);
    if (length <= sine * 1.0001f) return {0, size};
    const float centre = std::atan2(along, normal), reach = std::asin(sine / length);
    const float quarter = 0.25f * pi;
    float low = centre - reach, high = centre + reach;
    if (low > quarter || high < -quarter) return {0, 0};
    low = low < -quarter ? -quarter : low;
    high = high > quarter ? quarter : high;
    int begin = static_cast<int>(std::floor((std::tan(low) + 1) * 0.5f * size - 0.51f));
    int end = static_cast<int>(std::ceil((std::tan(high) + 1) * 0.5f * size - 0.49f)) + 1;
    begin = begin < 0 ? 0 : begin;
    end = end > size ? size : end;
    return {begin, end};
}

/// index: texel of the output.
inline void zonal_gather(const ZonalParameters& p, std::int64_t index) {
    const int out_face = static_cast<int>(index / (p.out_size * p.out_size));
    const int out_row = static_cast<int>(index / p.out_size % p.out_size);
    const int out_column = static_cast<int>(index % p.out_size);
    const Vec3 n = glm::normalize(cube_direction(out_face, texel_centre(out_column, p.out_size),
                                                 texel_centre(out_row, p.out_size)));
    const std::int64_t size = p.source_size, plane = 6 * size * size;
    const ZonalKernel kernel = p.kernel;
    const float sine = std::sin(kernel.cut_angle);
    // The corners of a face are 54.7 degrees off its centre.
    const float farthest = kernel.cut_angle + 0.9554f;
    const float face_cut = farthest < pi ? std::cos(farthest) : -1.0f;
    float sums[4] = {0, 0, 0, 0};
    for (int face = 0; face < 6; ++face) {
        const CubeFrame frame = cube_frame(face);
        const float normal = glm::dot(frame.normal, n);
        if (normal < face_cut) continue;
        const float along_s = glm::dot(frame.s, n), along_t = glm::dot(frame.t, n);
        const TexelRange rows = cone_range(along_t, normal, sine, p.source_size);
        if (rows.begin >= rows.end) continue;
        const TexelRange columns = cone_range(along_s, normal, sine, p.source_size);
        for (int row = rows.begin; row < rows.end; ++row) {
            const float t = p.centres[row];
            const float rest = along_t * t + normal, squared = 1 + t * t;
            const float* red = p.source + (face * size + row) * size;
            const float* green = red + plane;
            const float* blue = green + plane;
            const float* solid_angle = blue + plane;
            float r = 0, g = 0, b = 0, w = 0;
#pragma omp simd reduction(+ : r, g, b, w)
            for (int column = columns.begin; column < columns.end; ++column) {
                const float s = p.centres[column];
                const float c = (along_s * s + rest) / std::sqrt(squared + s * s);
                float k = kernel.profile(c) - kernel.floor;
                k = c > kernel.cut && k > 0 ? k : 0.0f;
                r += k * red[column];
                g += k * green[column];
                b += k * blue[column];
                w += k * solid_angle[column];
            }
            sums[0] += r;
            sums[1] += g;
            sums[2] += b;
            sums[3] += w;
        }
    }
    for (int c = 0; c < 4; ++c)
        p.out[4 * index + c] = sums[c];
}

}  // namespace item3d::kernels
