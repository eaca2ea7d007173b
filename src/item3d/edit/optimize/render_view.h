// Renders of the model with its neural texture: for the prior, from the cameras of an iteration,
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

/// The field-independent part of N views, on R' x R' pixels with R' >= R.
struct GBuffer {
    Raster raster;
    Surface surface;
    SeenShape shape;
    OwnMaterial own;  ///< the model's own materials
};

GBuffer rasterize_views(const EditScene& scene, const EditPlan& plan,
                        const std::vector<Camera>& cameras);

/// The share of an iteration's N views that this process hands to the prior. With fewer views than
/// processes, each process shades a part of all their points (ViewOptions::processes).
struct ViewShare {
    int total = 0;  ///< N
    Share own;
    bool by_points = false;
    /// Views of the G-buffer: all where points are shared out, else this process's.
    Share drawn() const { return by_points ? Share{0, total} : own; }
};
ViewShare share_views(const ProcessGroup& processes, int total);

struct EditView {
    at::Tensor images;        ///< [N, 3, R, R] sRGB, differentiable in the field
    at::Tensor coverage;      ///< [N, 1, R, R] 0 to 1, covered part of each pixel
    MaterialSample material;  ///< at this process's share of the surface points
    Surface surface;          ///< points at which the material was looked up
    Share points;             ///< indices of those points in the G-buffer
};

struct ViewOptions {
    std::int64_t iteration = 0;  ///< seed of light and background, with the settings' seed
    /// Standard deviation of random offsets of the lookup points, in pixels, so that one image
    /// trains all of a pixel's area and not one point of it.
    float spread = 0;
    std::uint64_t spread_draw = 0;            ///< index of the draw of those offsets
    const EnvironmentLight* light = nullptr;  ///< null: the scene's light for the iteration
    /// Processes that share out the points of the images. Each gets the whole images, whose
    /// backward pass all must call together (gather_rows()).
    ProcessGroup processes = {};
    int first_view = 0;   ///< index of the G-buffer's first view among the iteration's
    int total_views = 0;  ///< number of the iteration's views; 0: those of the G-buffer
};

EditView render_view(const EditScene& scene, const EditPlan& plan, NeuralTexture& field,
                     const GBuffer& gbuffer, const ViewOptions& options);

/// Prefilters a light that is optimised; differentiable in its parameters.
EnvironmentLight prefilter_light(const EditScene& scene, const LightModel& light);

/// Returns the current light without an autograd graph: the optimised one, or the scene's first.
EnvironmentLight current_light(const EditScene& scene, const EditState& state);

/// Returns `count` cameras around the model, slightly above it.
std::vector<Camera> field_cameras(const EditScene& scene, int count);

/// Renders the current field: [N, size, size, 3] sRGB in [0, 1], on light grey, without an autograd
/// graph.
at::Tensor draw_field(const EditScene& scene, NeuralTexture& field, const EnvironmentLight& light,
                      const std::vector<Camera>& cameras, int size);

}  // namespace item3d
