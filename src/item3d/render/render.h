// Rendering of images of a textured model: the entry point of the renderer.
#pragma once

#include "item3d/render/textured_materials.h"

#include <memory>
#include <optional>
#include <vector>

namespace item3d {

class IndirectLight;
class Occlusion;

struct RenderOptions {
    int width = 512;
    int height = 512;
    /// Supersampling: each pixel is the mean of n x n sub-pixels, in addition to edge antialiasing.
    int supersampling = 2;
    /// Linear RGB behind the model; without a value, the background is transparent.
    std::optional<Vec3> background;
    ShadeOptions shade;
    /// Occlusion of the light by the model itself (occlusion.h), or null.
    std::shared_ptr<const Occlusion> occlusion;
    /// Indirect light between surfaces (indirect_light.h), on the CPU, or null.
    std::shared_ptr<const IndirectLight> indirect;
    int indirect_rays = 16;  ///< number of rays for each specular lobe
};

/// Returns one image per camera: [N, H, W, 4] linear radiance, premultiplied, with coverage in A (1
/// where a background is given). This function is for images of textured models. An optimisation
/// calls the renderer's operations itself.
at::Tensor render(const Geometry& geometry, const TexturedMaterials& materials,
                  const EnvironmentLight& light, const std::vector<Camera>& cameras,
                  const RenderOptions& options);

}  // namespace item3d
