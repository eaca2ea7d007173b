// The timing of the renderer's stages, for `item3d bench render`.
#pragma once

#include "apps/item3d/edit/image_options.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <string>
#include <vector>

namespace item3d {

/// Median times of a stage in milliseconds.
struct StageTime {
    std::string stage;
    double forward_ms = 0;
    double backward_ms = 0;  ///< time of the gradient alone
};

struct RenderTimes {
    std::vector<StageTime> stages;
    /// Time to render one view, from positions to an antialiased image, with one sample per pixel.
    double forward_ms = 0;
    /// Time to render the view and to compute its mean square and the gradient of that with respect
    /// to the base colour texture.
    double forward_backward_ms = 0;
    /// The two times above for a neural texture in place of the model's textures. The gradient is
    /// with respect to the parameters of the neural texture.
    double neural_forward_ms = 0;
    double neural_forward_backward_ms = 0;
    std::int64_t covered_pixels = 0;
};

/// Model to be rendered, with its camera.
struct BenchScene {
    std::string name;
    Model model;
    Camera camera(ImageSize size) const;  ///< shows the whole model as large as possible
};

/// Returns a sphere of 2 * squares^2 triangles with a texture of 1024 x 1024 texels.
BenchScene sphere_scene(int squares);

/// Times the renderer. light: linear equirectangular radiance.
RenderTimes time_render(const BenchScene& scene, const Image& light, ImageSize size,
                        at::Device device, int repeats);

/// Times the prefiltering, on the CPU, of an environment with size x size texels per face.
StageTime time_prefilter(int size, int repeats);

}  // namespace item3d
