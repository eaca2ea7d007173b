// What the prior is shown: the model with the neural texture, from the cameras of an iteration.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// What N views show whatever the field holds, on R' x R' pixels: R or finer.
struct SeenModel {
    Raster raster;
    Surface surface;
    SeenShape shape;
    MaterialSample own;  ///< the model's own materials
};

SeenModel see_model(const EditScene& scene, const EditSettings& settings,
                    const std::vector<Camera>& cameras);

struct EditView {
    at::Tensor images;        ///< [N, 3, R, R] sRGB, differentiable in the field
    at::Tensor coverage;      ///< [N, 1, R, R] 0 .. 1, how much of each pixel the model covers
    MaterialSample material;  ///< at the surface points of the picture
    Surface surface;          ///< those points, where the material was looked up
};

struct ViewOptions {
    std::int64_t iteration = 0;  ///< draws light and background, with the settings' seed
    /// Offsets of the points where the material is looked up, in pixels (standard deviation), so
    /// that what is learnt from one picture covers its pixels and not a point in each.
    float spread = 0;
    std::uint64_t spread_draw = 0;            ///< another draw of those offsets
    const EnvironmentLight* light = nullptr;  ///< null: what the scene's lights have for it
};

/// What these views show of the model in `sphere`.
SeenShape seen_shape(const Raster& raster, const Surface& surface, const BoundingSphere& sphere);

EditView render_view(const EditScene& scene, const EditSettings& settings, NeuralTexture& field,
                     const SeenModel& seen, const ViewOptions& options);

}  // namespace item3d
