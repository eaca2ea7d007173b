// Split-sum shading of one surface point (Karis 2013), and its hand-written gradient.
//
//     L = occlusion ((1 - metallic) c E(n) + P(r) (F0 A + B) (1 + F0 (1 / (A + B) - 1)))
//     F0 = (1 - metallic) 0.04 + metallic c        r = n + v (2 (n.view) n - view - n)
//
// Here c is the base colour, n the normal, `view` the direction to the camera, E the irradiance
// divided by pi, P the prefiltered radiance, and A and B are the table's values at n.view and
// roughness (bsdf.h). The last factor restores the energy that single scattering loses between
// microfacets (Turquin 2019, "Practical multiple scattering compensation for microfacet models").
// The weight v, which is 1 for smooth surfaces, turns r from the mirror direction towards the
// normal (DominantDirection). P is the cubic through four levels over x = log roughness, sum_k P_k
// prod_(j != k) (x - x_j) / (x_k - x_j).
//
// The backward pass computes the point again and applies the chain rule to these formulas, the last
// one first. The normal is n = m / |m| with m = t_x T + t_y B + t_z N, where t is the normal map's
// value and T, B, N the tangent frame. A gradient g with respect to n becomes (g - n (n.g)) / |m|
// with respect to m.
//
//     points    [P, 3] each; orm: occlusion, roughness, metallic; tangent [P, 4], handedness last
//     diffuse   [6, D, D, 3]        specular  [6, S, S, 3] each level        bsdf  [B, B, 2]
#pragma once

#include "item3d/core/host_device.h"
#include "item3d/core/math.h"
#include "item3d/render/kernels/cube.h"
#include "item3d/render/kernels/interpolate.h"

#include <cmath>
#include <cstdint>

namespace item3d::kernels {

inline constexpr int max_specular_levels = 16;
inline constexpr float dielectric_f0 = 0.04f;
/// Lower bound of n.v, below the table's first texel. It is needed because interpolated normals may
/// turn away from the viewer.
inline constexpr float smallest_n_dot_v = 1e-3f;

struct ShadeParameters {
    const float* base_color;  ///< [P, 3]
    const float* orm;         ///< [P, 3]
    const float* normal_map;  ///< [P, 3] in tangent space; null for the surface's normal
    const float* normal;      ///< [P, 3]
    const float* tangent;     ///< [P, 4]
    const float* view;        ///< [P, 3]
    const float* bsdf;        ///< [B, B, 2]
    int bsdf_size;            ///< B
    bool multiple_scattering;
    const float* diffuse;  ///< [6, D, D, 3]
    int diffuse_size;      ///< D
    int levels;
    const float* specular[max_specular_levels];  ///< [6, S, S, 3] each
    int specular_size[max_specular_levels];
    float specular_log_roughness[max_specular_levels];  ///< ascending
    /// Lagrange scales of the cubic through levels [first, first + 4). A scale is 1 divided by the
    /// product of a node's differences from the other three nodes.
    float specular_scale[max_specular_levels][4];

    float* radiance;  ///< [P, 3]

    // Members of the backward pass. Any of the gradients may be null.
    const float* radiance_gradient;  ///< [P, 3]
    float* base_color_gradient;
    float* orm_gradient;
    float* normal_map_gradient;
    float* normal_gradient;
};

/// Destination of the light's gradients. It has the indices of the maps' first elements in `sums`.
/// An index is -1 if the gradient is not wanted.
struct LightGradient {
    Accumulator sums;
    std::int64_t diffuse = -1;
    std::int64_t specular[max_specular_levels] = {-1, -1, -1, -1, -1, -1, -1, -1,
                                                  -1, -1, -1, -1, -1, -1, -1, -1};
};

struct ShadeBackwardParameters {
    ShadeParameters shade;
    LightGradient light;
};

struct ShadingFrame {
    Vec3 surface, raw_tangent, tangent, bitangent, map, unnormalized, normal;
    float handedness, inverse_tangent, inverse_length;
};

/// Returns the surface's shading frame, with the normal perturbed by the normal map.
ITEM3D_HOST_DEVICE inline ShadingFrame shading_frame(const ShadeParameters& p, std::int64_t i) {
    ShadingFrame f;
    f.surface = load3(p.normal + 3 * i);
    f.normal = f.surface;
    if (p.normal_map == nullptr) return f;
    f.map = load3(p.normal_map + 3 * i);
    f.raw_tangent = load3(p.tangent + 4 * i);
    f.handedness = p.tangent[4 * i + 3];
    Vec3 across = f.raw_tangent - f.surface * glm::dot(f.surface, f.raw_tangent);
    if (!(glm::dot(across, across) > 1e-12f)) {
        // Without UVs, any frame is valid.
        f.raw_tangent = std::fabs(f.surface.x) < 0.7f ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        f.handedness = 1;
        across = f.raw_tangent - f.surface * glm::dot(f.surface, f.raw_tangent);
    }
    f.inverse_tangent = 1 / std::sqrt(glm::dot(across, across));
    f.tangent = across * f.inverse_tangent;
    f.bitangent = f.handedness * glm::cross(f.surface, f.tangent);
    f.unnormalized = f.map.x * f.tangent + f.map.y * f.bitangent + f.map.z * f.surface;
    const float squared = glm::dot(f.unnormalized, f.unnormalized);
    f.inverse_length = 1 / std::sqrt(squared > 1e-12f ? squared : 1e-12f);
    f.normal = f.unnormalized * f.inverse_length;
    return f;
}

/// Result of a bilinear lookup in the BSDF table, with derivatives.
struct BsdfValue {
    float scale, bias;
    float scale_by_view, bias_by_view;            ///< d / d n.v
    float scale_by_roughness, bias_by_roughness;  ///< d / d roughness
};

ITEM3D_HOST_DEVICE inline BsdfValue bsdf_lookup(const float* table, int size, float n_dot_v,
                                                float roughness) {
    const float limit = static_cast<float>(size - 1);
    const float raw_x = n_dot_v * size - 0.5f, raw_y = roughness * size - 0.5f;
    const float x = raw_x < 0 ? 0.0f : (raw_x > limit ? limit : raw_x);
    const float y = raw_y < 0 ? 0.0f : (raw_y > limit ? limit : raw_y);
    const int x0 = x < limit ? static_cast<int>(x) : size - 2;
    const int y0 = y < limit ? static_cast<int>(y) : size - 2;
    const float fx = x - x0, fy = y - y0;
    const float slope_x = raw_x == x ? static_cast<float>(size) : 0.0f;
    const float slope_y = raw_y == y ? static_cast<float>(size) : 0.0f;
    const float* t00 = table + 2 * (y0 * size + x0);
    const float* t10 = t00 + 2 * size;
    float value[2], by_x[2], by_y[2];
    for (int c = 0; c < 2; ++c) {
        const float upper = t00[c] + fx * (t00[c + 2] - t00[c]);
        const float lower = t10[c] + fx * (t10[c + 2] - t10[c]);
        value[c] = upper + fy * (lower - upper);
        by_x[c] = slope_x * ((1 - fy) * (t00[c + 2] - t00[c]) + fy * (t10[c + 2] - t10[c]));
        by_y[c] = slope_y * (lower - upper);
    }
    return {value[0], value[1], by_x[0], by_x[1], by_y[0], by_y[1]};
}

/// Four adjacent levels around a roughness, and their weights.
struct SpecularLevels {
    int first;
    float weight[4];
    float slope[4];  ///< d weight / d roughness
};

/// Returns the weights of the cubic through the levels, as a function of the logarithm of
/// roughness. Lobes keep their shape over this logarithm, so that few levels suffice. Beyond the
/// chain's ends the weights are constant.
ITEM3D_HOST_DEVICE inline SpecularLevels specular_levels(const ShadeParameters& p,
                                                         float roughness) {
    const float* nodes = p.specular_log_roughness;
    const float limit = nodes[p.levels - 1];
    const float raw = std::log(roughness > 1e-6f ? roughness : 1e-6f);
    const float x = raw < nodes[0] ? nodes[0] : (raw > limit ? limit : raw);
    int first = 0;
    while (first + 4 < p.levels && x >= nodes[first + 2])
        ++first;
    const float slope = raw == x ? 1 / roughness : 0.0f;
    const float* scale = p.specular_scale[first];
    const float a = x - nodes[first], b = x - nodes[first + 1];
    const float c = x - nodes[first + 2], d = x - nodes[first + 3];
    const float ab = a * b, cd = c * d;
    return {first,
            {scale[0] * b * cd, scale[1] * a * cd, scale[2] * ab * d, scale[3] * ab * c},
            {slope * scale[0] * (cd + b * (c + d)), slope * scale[1] * (cd + a * (c + d)),
             slope * scale[2] * (ab + d * (a + b)), slope * scale[3] * (ab + c * (a + b))}};
}

/// Lean of rough lobes from the mirror direction towards the normal (Lagarde and de Rousiers 2014,
/// "Moving Frostbite to PBR", section 4.9.3). value: remaining weight of the mirror direction.
/// Below roughness 0.25 the lean adds more error than it removes (docs/renderer.md), so it is faded
/// in.
struct DominantDirection {
    float value;
    float slope;  ///< d value / d roughness
};

ITEM3D_HOST_DEVICE inline DominantDirection dominant_direction(float roughness) {
    constexpr float begin = 0.25f, end = 0.5f;
    if (roughness <= begin) return {1, 0};
    const float alpha = roughness * roughness;
    const float smoothness = alpha < 1 ? 1 - alpha : 0.0f;
    const float root = std::sqrt(smoothness);
    const float lean = smoothness * (root + alpha) - 1;
    const float slope = alpha < 1 ? (smoothness - alpha - 1.5f * root) * 2 * roughness : 0.0f;
    if (roughness >= end) return {1 + lean, slope};
    const float x = (roughness - begin) / (end - begin);
    const float fade = x * x * (3 - 2 * x), fade_slope = 6 * x * (1 - x) / (end - begin);
    return {1 + fade * lean, fade * slope + fade_slope * lean};
}

/// Intermediate values that the forward and the backward pass share.
struct ShadingPoint {
    ShadingFrame frame;
    Vec3 view, mirrored, reflected, base_color, f0;
    DominantDirection dominant;
    float occlusion, roughness, metallic, n_dot_v;
    bool view_clamped;
    CubeTaps diffuse_taps, specular_taps[4];
    SpecularLevels levels;
    Vec3 irradiance, prefiltered[4], specular;
    BsdfValue bsdf;
    float albedo, lost;  ///< single-scattering albedo at F0 = 1, and 1 / albedo - 1
    Vec3 single, boost;  ///< reflectance F0 A + B, and the factor for multiple scattering
    Vec3 diffuse_part, specular_part;
};

ITEM3D_HOST_DEVICE inline ShadingPoint shading_point(const ShadeParameters& p, std::int64_t i) {
    ShadingPoint s;
    s.frame = shading_frame(p, i);
    s.view = load3(p.view + 3 * i);
    s.base_color = load3(p.base_color + 3 * i);
    s.occlusion = p.orm[3 * i];
    s.roughness = p.orm[3 * i + 1];
    s.metallic = p.orm[3 * i + 2];

    const float cosine = glm::dot(s.frame.normal, s.view);
    s.view_clamped = cosine < smallest_n_dot_v;
    s.n_dot_v = s.view_clamped ? smallest_n_dot_v : cosine;
    s.mirrored = 2 * cosine * s.frame.normal - s.view;
    s.dominant = dominant_direction(s.roughness);
    s.reflected = s.frame.normal + s.dominant.value * (s.mirrored - s.frame.normal);

    s.diffuse_taps = cube_taps(cube_point(s.frame.normal), p.diffuse_size);
    s.irradiance = cube_value(p.diffuse, s.diffuse_taps);
    s.levels = specular_levels(p, s.roughness);
    const CubePoint reflected = cube_point(s.reflected);
    s.specular = Vec3(0.0f);
    for (int k = 0; k < 4; ++k) {
        const int level = s.levels.first + k;
        s.specular_taps[k] = cube_taps(reflected, p.specular_size[level]);
        s.prefiltered[k] = cube_value(p.specular[level], s.specular_taps[k]);
        s.specular += s.levels.weight[k] * s.prefiltered[k];
    }

    s.bsdf = bsdf_lookup(p.bsdf, p.bsdf_size, s.n_dot_v, s.roughness);
    s.albedo = s.bsdf.scale + s.bsdf.bias;
    s.lost = p.multiple_scattering ? 1 / s.albedo - 1 : 0.0f;
    s.f0 = Vec3(dielectric_f0 * (1 - s.metallic)) + s.metallic * s.base_color;
    s.single = s.f0 * s.bsdf.scale + Vec3(s.bsdf.bias);
    s.boost = Vec3(1.0f) + s.lost * s.f0;
    s.diffuse_part = (1 - s.metallic) * s.base_color * s.irradiance;
    s.specular_part = s.specular * s.single * s.boost;
    return s;
}

ITEM3D_HOST_DEVICE inline void shade_forward(const ShadeParameters& p, std::int64_t i) {
    const ShadingPoint s = shading_point(p, i);
    store3(p.radiance + 3 * i, s.occlusion * (s.diffuse_part + s.specular_part));
}

ITEM3D_HOST_DEVICE inline float sum(Vec3 v) {
    return v.x + v.y + v.z;
}

ITEM3D_HOST_DEVICE inline void shade_backward(const ShadeParameters& p, std::int64_t i,
                                              const LightGradient& light) {
    const ShadingPoint s = shading_point(p, i);
    const Vec3 out = load3(p.radiance_gradient + 3 * i);
    const Vec3 g = s.occlusion * out;

    const Vec3 reflectance = g * s.specular;  // d / d (single * boost)
    const Vec3 by_single = reflectance * s.boost, by_boost = reflectance * s.single;
    const Vec3 by_f0 = by_single * s.bsdf.scale + by_boost * s.lost;
    // lost = 1 / (scale + bias) - 1
    const float by_albedo =
        p.multiple_scattering ? -sum(by_boost * s.f0) / (s.albedo * s.albedo) : 0.0f;
    const float by_scale = sum(by_single * s.f0) + by_albedo;
    const float by_bias = sum(by_single) + by_albedo;
    const Vec3 by_irradiance = (1 - s.metallic) * g * s.base_color;
    const Vec3 by_specular = g * s.single * s.boost;

    if (p.base_color_gradient != nullptr)
        store3(p.base_color_gradient + 3 * i,
               (1 - s.metallic) * g * s.irradiance + s.metallic * by_f0);
    if (light.diffuse >= 0)
        cube_add_gradient(light.sums, light.diffuse, s.diffuse_taps, by_irradiance);
    Vec3 by_reflected(0.0f);
    float by_roughness = 0;  // gradient through the levels' weights
    for (int k = 0; k < 4; ++k) {
        const int level = s.levels.first + k;
        const Vec3 by_level = s.levels.weight[k] * by_specular;
        if (light.specular[level] >= 0)
            cube_add_gradient(light.sums, light.specular[level], s.specular_taps[k], by_level);
        by_reflected += cube_direction_gradient(p.specular[level], s.specular_taps[k], by_level);
        by_roughness += s.levels.slope[k] * glm::dot(by_specular, s.prefiltered[k]);
    }
    const Vec3 by_mirrored = s.dominant.value * by_reflected;
    if (p.orm_gradient != nullptr) {
        p.orm_gradient[3 * i] = sum(out * (s.diffuse_part + s.specular_part));
        p.orm_gradient[3 * i + 1] =
            by_scale * s.bsdf.scale_by_roughness + by_bias * s.bsdf.bias_by_roughness +
            by_roughness + s.dominant.slope * glm::dot(by_reflected, s.mirrored - s.frame.normal);
        p.orm_gradient[3 * i + 2] = sum(by_f0 * (s.base_color - Vec3(dielectric_f0))) -
                                    sum(g * s.base_color * s.irradiance);
    }
    if (p.normal_gradient == nullptr && p.normal_map_gradient == nullptr) return;
    const ShadingFrame& f = s.frame;
    const float by_n_dot_v =
        s.view_clamped ? 0.0f : by_scale * s.bsdf.scale_by_view + by_bias * s.bsdf.bias_by_view;
    // mirrored = 2 (n.v) n - v
    Vec3 by_normal = cube_direction_gradient(p.diffuse, s.diffuse_taps, by_irradiance) +
                     by_n_dot_v * s.view + (by_reflected - by_mirrored) +
                     2.0f * (glm::dot(f.normal, s.view) * by_mirrored +
                             glm::dot(by_mirrored, f.normal) * s.view);
    if (p.normal_map == nullptr) {
        store3(p.normal_gradient + 3 * i, by_normal);
        return;
    }
    by_normal = (by_normal - f.normal * glm::dot(f.normal, by_normal)) * f.inverse_length;
    if (p.normal_map_gradient != nullptr)
        store3(p.normal_map_gradient + 3 * i,
               Vec3(glm::dot(by_normal, f.tangent), glm::dot(by_normal, f.bitangent),
                    glm::dot(by_normal, f.surface)));
    if (p.normal_gradient != nullptr) {
        const Vec3 by_bitangent = f.map.y * f.handedness * by_normal;
        Vec3 by_tangent = f.map.x * by_normal + glm::cross(by_bitangent, f.surface);
        by_tangent = (by_tangent - f.tangent * glm::dot(f.tangent, by_tangent)) * f.inverse_tangent;
        // across = raw - n (n.raw)
        store3(p.normal_gradient + 3 * i, f.map.z * by_normal +
                                              glm::cross(f.tangent, by_bitangent) -
                                              glm::dot(by_tangent, f.surface) * f.raw_tangent -
                                              glm::dot(f.surface, f.raw_tangent) * by_tangent);
    }
}

/// True if a point's directions have a length. Interpolation leaves zeros at pixels of the
/// background.
ITEM3D_HOST_DEVICE inline bool has_directions(const ShadeParameters& p, std::int64_t i) {
    const auto has_length = [](Vec3 v) { return glm::dot(v, v) > 0; };
    return has_length(load3(p.normal + 3 * i)) && has_length(load3(p.view + 3 * i)) &&
           (p.normal_map == nullptr || has_length(load3(p.normal_map + 3 * i)));
}

/// Shades a point, or writes zeros for one without directions.
ITEM3D_HOST_DEVICE inline void shade_pixel(const ShadeParameters& p, std::int64_t i) {
    if (has_directions(p, i))
        shade_forward(p, i);
    else
        store3(p.radiance + 3 * i, Vec3(0.0f));
}

/// Gradient of shade_pixel(). It leaves a point without directions as it is.
ITEM3D_HOST_DEVICE inline void shade_pixel_backward(const ShadeParameters& p, std::int64_t i,
                                                    const LightGradient& light) {
    if (has_directions(p, i)) shade_backward(p, i, light);
}

}  // namespace item3d::kernels
