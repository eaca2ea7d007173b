// Renders of the model with its neural texture. Some are for the prior, from the cameras of an
// iteration; others are for people and captioners.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// The part of N views that does not depend on the field. It has R' x R' pixels a view; R' is R or,
/// for supersampling, a multiple of R.
struct GBuffer {
    Raster raster;
    Surface surface;
    SeenShape shape;
    OwnMaterial own;  ///< the model's own materials
};

GBuffer rasterize_views(const EditScene& scene, const EditPlan& plan,
                        const std::vector<Camera>& cameras);

/// The share of an iteration's N views that this process hands to the prior. If there are fewer
/// views than processes, each process shades a part of the points of all views
/// (ViewOptions::processes).
struct ViewShare {
    int total = 0;  ///< N
    Share own;
    bool by_points = false;
    /// Returns the views of the G-buffer: all views if their points are shared out, else this
    /// process's views.
    Share drawn() const { return by_points ? Share{0, total} : own; }
};
ViewShare share_views(const ProcessGroup& processes, int total);

struct EditView {
    at::Tensor images;        ///< [N, 3, R, R] sRGB, differentiable in the field
    at::Tensor coverage;      ///< [N, 1, R, R] covered part of each pixel, 0 to 1
    MaterialSample material;  ///< at this process's share of the surface points
    Surface surface;          ///< points at which the material was looked up
    Share points;             ///< indices of those points in the G-buffer
};

struct ViewOptions {
    std::int64_t iteration = 0;  ///< chooses light and background, with the settings' seed
    /// Standard deviation, in pixels, of random offsets of the points at which the material is
    /// looked up. With offsets, an image trains a pixel's whole area and not only one point of it.
    float spread = 0;
    std::uint64_t spread_draw = 0;            ///< index of the offsets' random draw
    const EnvironmentLight* light = nullptr;  ///< null: the scene's light for the iteration
    /// Processes that share out the points of the images. Each process gets the whole images. All
    /// processes must call the backward pass of the images together (gather_rows()).
    ProcessGroup processes = {};
    int first_view = 0;   ///< index of the G-buffer's first view among the iteration's
    int total_views = 0;  ///< number of the iteration's views; 0: those of the G-buffer
};

EditView render_view(const EditScene& scene, const EditPlan& plan, NeuralTexture& field,
                     const GBuffer& gbuffer, const ViewOptions& options);

/// Prefilters a light that is optimised. The result is differentiable in the light's parameters.
EnvironmentLight prefilter_light(const EditScene& scene, const LightModel& light);

/// Returns the current light without an autograd graph. It is the optimised light, if there is one,
/// else the scene's first light.
EnvironmentLight current_light(const EditScene& scene, const EditState& state);

/// Returns `count` cameras around the model, slightly above it.
std::vector<Camera> field_cameras(const EditScene& scene, int count);

/// Renders the current field on light grey. Returns [N, size, size, 3], sRGB in [0, 1], without an
/// autograd graph.
at::Tensor draw_field(const EditScene& scene, NeuralTexture& field, const EnvironmentLight& light,
                      const std::vector<Camera>& cameras, int size);

}  // namespace item3d
