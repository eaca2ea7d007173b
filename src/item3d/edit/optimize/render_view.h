// Pictures of the model with its neural texture: for the prior, from the cameras of an iteration,
// and for people and captioners.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// The part of N views that does not depend on the field, on R' x R' pixels: R or finer.
struct GBuffer {
    Raster raster;
    Surface surface;
    SeenShape shape;
    OwnMaterial own;  ///< the model's own materials
};

GBuffer rasterize_views(const EditScene& scene, const EditPlan& plan,
                        const std::vector<Camera>& cameras);

/// Where some of the N views of an iteration are this process's to hand to the prior. With fewer
/// views than processes, each process shades a part of all their points (ViewOptions::processes).
struct ViewShare {
    int total = 0;  ///< N
    Share own;
    bool by_points = false;
    /// Of the G-buffer: all views where points are shared out, this process's otherwise.
    Share drawn() const { return by_points ? Share{0, total} : own; }
};
ViewShare share_views(const ProcessGroup& processes, int total);

struct EditView {
    at::Tensor images;    ///< [N, 3, R, R] sRGB, differentiable in the field
    at::Tensor coverage;  ///< [N, 1, R, R] 0 .. 1, how much of each pixel the model covers
    MaterialSample
        material;     ///< at the surface points of the picture, this process's share of them
    Surface surface;  ///< those points, where the material was looked up
    Share points;     ///< their places among the G-buffer's
};

struct ViewOptions {
    std::int64_t iteration = 0;  ///< draws light and background, with the settings' seed
    /// Offsets of the points where the material is looked up, in pixels (standard deviation), so
    /// that what is learnt from one picture covers its pixels and not a point in each.
    float spread = 0;
    std::uint64_t spread_draw = 0;            ///< another draw of those offsets
    const EnvironmentLight* light = nullptr;  ///< null: what the scene's lights have for it
    /// Processes that share out the points of the pictures; each gets the pictures, whose backward
    /// pass all must call together (gather_rows()).
    ProcessGroup processes = {};
    int first_view = 0;   ///< of the G-buffer's views among the iteration's
    int total_views = 0;  ///< of the iteration; 0: those of the G-buffer
};

EditView render_view(const EditScene& scene, const EditPlan& plan, NeuralTexture& field,
                     const GBuffer& gbuffer, const ViewOptions& options);

/// A light that is optimised, as the renderer takes it; differentiable in its parameters.
EnvironmentLight prefilter_light(const EditScene& scene, const LightModel& light);

/// The light as it is now: the one that is optimised, or the first of the scene's. No graph.
EnvironmentLight current_light(const EditScene& scene, const EditState& state);

/// `count` cameras around the model, a little above it.
std::vector<Camera> field_cameras(const EditScene& scene, int count);

/// The field as it is: [N, size, size, 3] sRGB in [0, 1], a light grey behind. No graph.
at::Tensor draw_field(const EditScene& scene, NeuralTexture& field, const EnvironmentLight& light,
                      const std::vector<Camera>& cameras, int size);

}  // namespace item3d
