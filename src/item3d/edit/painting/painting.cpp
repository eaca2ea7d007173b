#include "item3d/edit/painting/painting.h"

#include "item3d/baselines/methods.h"
#include "item3d/core/date.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/load_networks.h"
#include "item3d/edit/optimize/checkpoint_state.h"
#include "item3d/edit/optimize/checkpoint_writer.h"
#include "item3d/edit/optimize/render_view.h"
#include "item3d/io/save.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/region/seen_shape.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"

namespace item3d {
namespace {

/// Longest edge of a painted texture, as in TEXTure. The images of a prior do not resolve more.
constexpr int largest_painted_edge = 1024;
/// Longest edge of a latent texture, as in SyncMVD.
constexpr int largest_latent_edge = 512;

std::unique_ptr<PaintingScene> painting_scene(const EditRequest& request, const EditScene& scene) {
    auto painting = std::make_unique<PaintingScene>();
    painting->prior = scene.prior();
    painting->inpainter = load_inpainter(request, scene.device, scene.precision, scene.to);
    painting->geometry = atlas_geometry(scene.model, scene.atlas, scene.device);
    painting->texels =
        std::make_unique<const TexelList>(scene.model, painting->geometry, scene.atlas,
                                          request.plan.texture_size, largest_painted_edge);
    painting->latent_texels =
        std::make_unique<const TexelList>(scene.model, painting->geometry, scene.atlas,
                                          request.plan.texture_size, largest_latent_edge);
    const Surface surface = painting->texels->on(scene.geometry);
    painting->source = linear_to_srgb(scene.textured->sample(surface).base_color.clamp(0, 1));
    painting->weight = scene.region ? scene.region->weight(surface)
                                    : at::ones({surface.count(), 1}, painting->source.options());
    painting->materials = scene.textured.get();
    for (const Primitive& primitive : scene.model.primitives)
        painting->points.insert(painting->points.end(), primitive.positions.begin(),
                                primitive.positions.end());
    painting->radius = scene.sphere.radius;
    painting->prompt = scene.to;
    painting->negative_prompt = request.plan.negative_prompt;
    painting->says_sides = PriorVocabulary::load(request.prior).open();
    painting->resolution = request.plan.resolution;
    painting->shape = [sphere = scene.sphere](const Raster& raster, const Surface& seen) {
        return seen_shape(raster, seen, sphere);
    };
    return painting;
}

void save_new_views(const EditRequest& request, const EditState& state, std::size_t& saved) {
    const auto& images = state.painter->images();
    for (; saved < images.size(); ++saved)
        save_image(request.output / painted_view_file(saved),
                   to_image(images[saved][0].permute({1, 2, 0})));
}

}  // namespace

std::string painted_view_file(std::size_t index) {
    return fmt::format("views/{:02}.png", index);
}

EditState begin_painting(const EditRequest& request, const EditScene& scene) {
    const at::NoGradGuard no_grad;
    EditState state;
    state.begun = utc_date();
    state.painting = painting_scene(request, scene);
    state.painter =
        make_painter(request.plan.method, *state.painting, request.plan.painter_options());
    state.prior_weights = scene.hashing_weights.get();
    state.networks = {state.painting->prior};
    if (state.painting->inpainter) state.networks.push_back(state.painting->inpainter);
    if (!request.resume) return state;
    if (load_state(request, state))
        note(fmt::format("resuming after step {} of {}", state.iteration,
                         request.plan.total_iterations));
    else
        note("no checkpoint in " + request.output.string() + ": starting from the beginning");
    return state;
}

void paint_views(const EditRequest& request, const EditScene& scene, EditState& state) {
    const at::NoGradGuard no_grad;
    const std::int64_t total = request.plan.total_iterations;
    make_output_folder(request.output / "views");
    std::size_t saved = 0;
    Progress progress(request.plan.method, total, state.iteration);
    CheckpointWriter checkpoints(request, scene, state.fitted);
    while (state.iteration < total) {
        try {
            state.painter->step(state.iteration);
        } catch (const Interrupted&) {  // thrown during a view, which is painted again on resume
            interrupt(request, state);
        }
        ++state.iteration;
        save_new_views(request, state, saved);
        progress.update(state.iteration);
        checkpoints.after_step(state, progress);
    }
    save_new_views(request, state, saved);
    save_state(request, state);
    state.painter->finish();
}

}  // namespace item3d
