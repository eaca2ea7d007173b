// Whole pictures of a textured model: the entry point of the renderer.
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
    /// Each pixel is the mean of samples x samples sub-pixels, on top of edge antialiasing.
    int supersampling = 2;
    /// Linear RGB behind the model; no value: transparent.
    std::optional<Vec3> background;
    ShadeOptions shade;
    /// Darkens what the model hides from the light (occlusion.h). Null: nothing.
    std::shared_ptr<const Occlusion> occlusion;
    /// What surfaces throw at each other (indirect_light.h), on the CPU. Null: nothing.
    std::shared_ptr<const IndirectLight> indirect;
    int indirect_rays = 16;  ///< of each mirrored lobe
};

/// One picture a camera: [N, H, W, 4] linear radiance, premultiplied, with coverage in A (1 where a
/// background was given). For pictures of textured models; the edit's loop has its own path.
at::Tensor render(const Geometry& geometry, const TexturedMaterials& materials,
                  const EnvironmentLight& light, const std::vector<Camera>& cameras,
                  const RenderOptions& options);

}  // namespace item3d
