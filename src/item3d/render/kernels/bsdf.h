// Directional albedo of GGX with height-correlated Smith masking, split by Schlick's Fresnel term
// F = F0 + (1 - F0) (1 - v.h)^5 (Karis 2013, "environment BRDF"):
//
//     integral of f(l, v) (n.l) dl = F0 A + B
//     A = mean of (1 - (1 - v.h)^5) G2 / G1        B = mean of (1 - v.h)^5 G2 / G1
//
// The means are over half vectors h with the distribution of normals that v sees, for which D, the
// Jacobian and G1 cancel. With 1 + Lambda(c) = (1 + sqrt(1 + alpha^2 (1 - c^2) / c^2)) / 2 (Heitz
// 2014):
//
//     G2 / G1 = (1 + Lambda_v) / (1 + Lambda_v + Lambda_l)
//
//     table  [256, 256, 2]      row: roughness, column: n.v, both at (k + 1/2) / 256; then A, B
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cmath>

namespace item3d::kernels {

/// Number of steps in n.v, and in roughness, of the table. The build computes this table
/// (tools/write_bsdf_table.cpp).
inline constexpr int bsdf_table_size = 256;

/// Quadrature rule. It has `azimuths` equal steps over half a turn, because the integrand is
/// periodic and even, and `size` abscissae and weights on [0, 1] along the cap.
struct BsdfRule {
    const float* azimuth_cosines;
    int azimuths;
    const float* points;
    const float* weights;
    int size;
};

/// Returns the scale A and the bias B of F0 for one n.v and perceptual roughness. Visible normals
/// are sampled as caps of the hemisphere (Dupuy and Benyoub 2023), which leaves the smooth weight
/// G2/G1. A cap's height u is replaced by u = tanh^2(x), which spreads out both of its ends, and
/// each azimuth is integrated up to the angle where the reflected direction drops below the
/// horizon.
ITEM3D_HOST_DEVICE inline Vec2 bsdf_scale_bias(float n_dot_v, float roughness,
                                               const BsdfRule& rule) {
    const float alpha = roughness * roughness, alpha2 = alpha * alpha;
    const Vec3 v(std::sqrt(1 - n_dot_v * n_dot_v), 0.0f, n_dot_v);
    const Vec3 stretched = glm::normalize(Vec3(alpha * v.x, 0.0f, v.z));
    const auto masking = [alpha2](float cosine) {  // 2 (1 + Lambda)
        const float squared = cosine * cosine;
        return 1 + std::sqrt(1 + alpha2 * (1 - squared) / squared);
    };
    const float masking_v = masking(n_dot_v);
    Vec2 total(0.0f);
    for (int i = 0; i < rule.azimuths; ++i) {
        const float cosine = rule.azimuth_cosines[i], sine2 = 1 - cosine * cosine;
        // Returns the half vector (alpha x, alpha y, z) at a cap's height, not normalised. Its
        // component y holds the square of y.
        const auto half_vector = [&](float height) {
            const float radius2 = height * height < 1 ? 1 - height * height : 0.0f;
            return Vec3(std::sqrt(radius2) * cosine + stretched.x, radius2 * sine2,
                        height + stretched.z);
        };
        const auto rises = [&](float height) {
            const Vec3 h = half_vector(height);
            return 2 * (v.x * alpha * h.x + v.z * h.z) * h.z >
                   v.z * (alpha2 * (h.x * h.x + h.y) + h.z * h.z);
        };
        float lowest = -stretched.z;
        if (!rises(lowest)) {
            float high = 1;
            // Ten halvings reduce an interval of up to 2 to about 1/500.
            for (int step = 0; step < 10; ++step) {
                const float middle = 0.5f * (lowest + high);
                if (rises(middle))
                    high = middle;
                else
                    lowest = middle;
            }
            lowest = high;
        }
        const float span = 1 + stretched.z;
        const float last = 1 - (lowest + stretched.z) / span;
        const float x_end = std::atanh(std::sqrt(last < 1 - 1e-5f ? last : 1 - 1e-5f));
        for (int j = 0; j < rule.size; ++j) {
            const float e = std::exp(-2 * x_end * rule.points[j]);
            const float t = (1 - e) / (1 + e), u = t * t;
            const Vec3 h = half_vector((1 - u) * span - stretched.z);
            const float inverse = 1 / std::sqrt(alpha2 * (h.x * h.x + h.y) + h.z * h.z);
            const float v_dot_h = (v.x * alpha * h.x + v.z * h.z) * inverse;
            const float l_z = 2 * v_dot_h * h.z * inverse - v.z;
            if (!(l_z > 0) || !(v_dot_h > 0)) continue;
            // G2/G1 = (1 + Lambda_v) / (1 + Lambda_v + Lambda_l); du = 2 t (1 - u) dx
            const float weight = rule.weights[j] * x_end * 2 * t * (1 - u) * masking_v /
                                 (masking_v + masking(l_z) - 2);
            const float grazing = v_dot_h < 1 ? 1 - v_dot_h : 0.0f;
            const float squared = grazing * grazing;
            const float fresnel = squared * squared * grazing;
            total += weight * Vec2(1 - fresnel, fresnel);
        }
    }
    return total / static_cast<float>(rule.azimuths);
}

}  // namespace item3d::kernels
