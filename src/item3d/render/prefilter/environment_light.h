// Split-sum image-based lighting (Karis 2013): an environment prefiltered once, looked up a pixel.
#pragma once

#include "item3d/scene/image.h"

#include <torch/types.h>

namespace item3d {

/// An environment made ready for shading. Cube faces are in OpenGL's order +X -X +Y -Y +Z -Z;
/// [6, S, S, 3] linear radiance. All tensors carry gradients back to what `prefilter` was given.
struct EnvironmentLight {
    torch::Tensor diffuse;                ///< [6, 128, 128, 3] irradiance / pi
    std::vector<torch::Tensor> specular;  ///< GGX-prefiltered chain, finest first; 4 levels or more
    std::vector<float> roughness;         ///< perceptual roughness of each level
    EnvironmentLight to(torch::Device device) const;
};

/// [H, 2H, 3] equirectangular linear radiance -> [6, size, size, 3], differentiable.
torch::Tensor equirectangular_to_cube(const torch::Tensor& equirectangular, int size);

/// The light of scene/environment.h's adjust_light, differentiable: [H, W, 3] equirectangular
/// radiance turned around +Y by `degrees` and multiplied by 2^exposure (scalar tensors). Columns
/// are interpolated, so the derivative by the angle is that of the line between two of them.
torch::Tensor adjust_light(const torch::Tensor& equirectangular, const torch::Tensor& degrees,
                           const torch::Tensor& exposure);

/// Differentiable in `cube` [6, S, S, 3]. S is a power of two in [16, 1024]; the chain has
/// eight lobes from roughness 0.08 on in equal ratios, spread over the resolutions from S down to
/// 64, then 0.5, 0.63, 0.79 and 1 at 32. (S <= 32: the first, then these.)
EnvironmentLight prefilter(const torch::Tensor& cube);

/// Convenience for fixed lights. size: edge of the finest cube face.
EnvironmentLight prefilter(const Image& equirectangular, int size = 256,
                           torch::Device device = torch::kCPU);

/// The 2D BSDF table, which the build computes: [256, 256, 2] float32, row = roughness, column
/// = n.v, texel centres at (k + 0.5) / 256; specular albedo = F0 * A + B for GGX (alpha =
/// roughness^2) with height-correlated Smith masking.
const torch::Tensor& bsdf_table();

}  // namespace item3d
