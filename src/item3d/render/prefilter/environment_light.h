// Split-sum image-based lighting (Karis 2013). An environment is prefiltered once and looked up for
// each pixel.
#pragma once

#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// A prefiltered environment. A map is [6, S, S, 3] linear radiance, with cube faces in OpenGL's
/// order +X -X +Y -Y +Z -Z. All tensors carry gradients to the input of prefilter().
struct EnvironmentLight {
    at::Tensor diffuse;                ///< [6, 128, 128, 3] irradiance / pi
    std::vector<at::Tensor> specular;  ///< GGX-prefiltered chain, finest first; 4 levels or more
    std::vector<float> roughness;      ///< perceptual roughness of each level
    EnvironmentLight to(at::Device device) const;
};

/// Prefilters `cube` [6, S, S, 3], differentiably; S is a power of two in [16, 1024]. The chain has
/// two parts. The roughness of the first eight lobes rises from 0.08 in equal ratios, at
/// resolutions from S down to 64. The second part has roughness 0.5, 0.63, 0.79 and 1 at resolution
/// 32. For S <= 32 the first part has only its first lobe.
EnvironmentLight prefilter(const at::Tensor& cube);

/// Prefilters an equirectangular image, for lights without gradients. size: edge of the finest cube
/// face.
EnvironmentLight prefilter(const Image& equirectangular, int size = 256,
                           at::Device device = at::kCPU);

}  // namespace item3d
