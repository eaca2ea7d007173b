// Light and material to radiance, at covered pixels alone; and pictures from radiance.
#pragma once

#include "item3d/render/prefilter/environment_light.h"
#include "item3d/render/rasterize.h"

#include <torch/types.h>

namespace item3d {

/// Material values at P surface points, linear. What a texture lookup or the neural field returns.
struct MaterialSample {
    torch::Tensor base_color;  ///< [P, 3] linear, [0, 1]
    torch::Tensor orm;         ///< [P, 3] occlusion, roughness (perceptual), metallic, [0, 1]
    torch::Tensor normal;      ///< [P, 3] tangent space, unit; undefined tensor: the surface's own
    torch::Tensor emissive;    ///< [P, 3] linear radiance; undefined: none
    torch::Tensor alpha;       ///< [P] coverage; undefined: opaque
};

struct ShadeOptions {
    /// Scales specular reflection by 1 + F0 (1 / (A + B) - 1), the light that bounces between
    /// microfacets more than once (Turquin 2019, "Practical multiple scattering compensation for
    /// microfacet models"): a white metal then reflects all light at any roughness. Off: single
    /// scattering, as most path tracers' GGX has it.
    bool multiple_scattering = true;
};

/// Outgoing radiance [P, 3], linear; differentiable in base_color, orm, normal, the surface's
/// normal and the light's tensors:
///   base_color (1 - metallic) irradiance(n) occlusion + specular(r, roughness) (F0 A + B)
///   occlusion
/// with F0 = lerp(0.04, base_color, metallic); emissive is added; r leans towards n as roughness
/// grows. Roughness below the chain's first (0.08) looks like it.
torch::Tensor shade(const Surface& surface, const MaterialSample& material,
                    const EnvironmentLight& light, const ShadeOptions& options = {});

/// Scatters [P, C] values into [N, H, W, C] with `background` [C] or [N, H, W, C] elsewhere.
torch::Tensor scatter(const torch::Tensor& values, const Surface& surface, const Raster& raster,
                      const torch::Tensor& background);

/// Both differentiable; the gradient of linear_to_srgb is bounded near 0.
torch::Tensor linear_to_srgb(const torch::Tensor& linear);
torch::Tensor srgb_to_linear(const torch::Tensor& encoded);

torch::Tensor to_tensor(const Image& image, torch::Device device = torch::kCPU);  ///< [H, W, C]
Image to_image(const torch::Tensor& tensor);  ///< from [H, W, C]

}  // namespace item3d
