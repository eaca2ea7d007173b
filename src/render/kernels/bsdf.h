// Directional albedo of GGX with height-correlated Smith masking, split by Schlick's Fresnel term.
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"

#include <cmath>

namespace item3d::kernels {

/// Scale and bias of F0 for one n.v and perceptual roughness. Visible normals are sampled as caps
/// of the hemisphere (Dupuy and Benyoub 2023), which leaves the smooth weight G2/G1, on a product
/// grid: the midpoint rule in azimuth, where the integrand is periodic and even, and `rule_points`
/// abscissae and weights on [0, 1] along the cap.
ITEM3D_HOST_DEVICE inline Vec2 bsdf_scale_bias(float n_dot_v, float roughness,
                                               const float* azimuth_cosines, int azimuths,
                                               const float* rule_points, const float* rule_weights,
                                               int rule_size) {
    const float alpha = roughness * roughness;
    const Vec3 v(std::sqrt(1 - n_dot_v * n_dot_v), 0.0f, n_dot_v);
    const Vec3 stretched = glm::normalize(Vec3(alpha * v.x, 0.0f, v.z));
    const float alpha2 = alpha * alpha;
    const auto lambda_1 = [alpha2](float cosine) {  // 1 + Lambda, times 2
        const float squared = cosine * cosine;
        return 1 + std::sqrt(1 + alpha2 * (1 - squared) / squared);
    };
    const float masking_v = lambda_1(n_dot_v);
    float scale = 0, bias = 0;
    for (int j = 0; j < rule_size; ++j) {
        const float z = (1 - rule_points[j]) * (1 + stretched.z) - stretched.z;
        const float radius = std::sqrt(z * z < 1 ? 1 - z * z : 0.0f);
        float row_scale = 0, row_bias = 0;
        for (int i = 0; i < azimuths; ++i) {
            const float cosine = azimuth_cosines[i];
            const float x = radius * cosine + stretched.x;
            const float y2 = radius * radius * (1 - cosine * cosine);
            const float hz = z + stretched.z;
            // h = (alpha x, alpha y, hz), normalised; only its x and z matter.
            const float inverse = 1 / std::sqrt(alpha2 * (x * x + y2) + hz * hz);
            const float v_dot_h = (v.x * alpha * x + v.z * hz) * inverse;
            const float l_z = 2 * v_dot_h * hz * inverse - v.z;
            if (!(l_z > 0) || !(v_dot_h > 0)) continue;
            // 1 + Lambda_v + Lambda_l = (2 (1 + Lambda_v) + 2 (1 + Lambda_l)) / 2 - 1
            const float weight = masking_v / (masking_v + lambda_1(l_z) - 2);
            const float grazing = 1 - v_dot_h;
            const float squared = grazing * grazing;
            const float fresnel = squared * squared * grazing;
            row_scale += weight * (1 - fresnel);
            row_bias += weight * fresnel;
        }
        scale += rule_weights[j] * row_scale;
        bias += rule_weights[j] * row_bias;
    }
    return Vec2(scale, bias) / static_cast<float>(azimuths);
}

}  // namespace item3d::kernels
