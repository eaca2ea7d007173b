// What each part of the renderer takes, for `item3d bench render`.
#pragma once

#include "apps/item3d/edit/picture_options.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <string>
#include <vector>

namespace item3d {

/// Milliseconds, medians.
struct StageTime {
    std::string stage;
    double forward_ms = 0;
    double backward_ms = 0;  ///< of the gradient alone
};

struct RenderTimes {
    std::vector<StageTime> stages;
    /// One view from positions to an antialiased picture, with one sample a pixel.
    double forward_ms = 0;
    /// The same, and the gradient of the mean square to the base colour texture.
    double forward_backward_ms = 0;
    /// The same two with the neural texture in place of the model's; gradients to its parameters.
    double neural_forward_ms = 0;
    double neural_forward_backward_ms = 0;
    std::int64_t covered_pixels = 0;
};

/// A model to be drawn, and what it is lit by.
struct BenchScene {
    std::string name;
    Model model;
    Camera camera(PictureSize size) const;  ///< the whole model, as large as it fits
};

/// A sphere of 2 * squares^2 triangles with a texture of 1024 x 1024 texels.
BenchScene sphere_scene(int squares);

/// light: linear equirectangular radiance.
RenderTimes time_render(const BenchScene& scene, const Image& light, PictureSize size,
                        at::Device device, int repeats);

/// Prefiltering of an environment of size x size texels a face, which is done on the CPU alone.
StageTime time_prefilter(int size, int repeats);

}  // namespace item3d
