// The loop: cameras -> render -> guidance -> backward -> step; then the detail stage.
#pragma once

#include "item3d/edit/edit.h"
#include "item3d/edit/optimize/adjustment.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/timing.h"
#include "item3d/field/adam.h"
#include "item3d/field/neural_texture.h"
#include "item3d/guidance/guidance.h"
#include "item3d/lighting/optimized/light_model.h"
#include "item3d/render/prefilter/environment_light.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// What the detail stage has done so far.
struct DetailState {
    NeuralTexture before{nullptr};  ///< the field at its beginning; empty: not begun
    Adam optimizer;
    std::vector<at::Tensor> targets;  ///< [1, 3, R, R] sRGB, one for each view so far
};

/// Everything that an edit changes; what a checkpoint holds.
struct EditState {
    NeuralTexture fitted{nullptr};  ///< the field as fitted to the input, for the bake's residual
    NeuralTexture field{nullptr};
    Adam optimizer;
    std::unique_ptr<LightModel> light;  ///< null where the light is not optimised
    EnvironmentLight first_light;       ///< what `light` began as
    std::unique_ptr<Guidance> guidance;
    DetailState detail;
    AdjustmentState adjustment;
    std::string prior_weights;  ///< hash_of_weights() of what guides it
    /// Iterations done, views of the detail stage included; iterations that a settled edit was
    /// spared count as done.
    std::int64_t iteration = 0;
    std::vector<float> direction_length;  ///< a curve of the report, one value an iteration
    std::vector<float> source_loss;       ///< another
};

/// Edge of the cube that a light is optimised on.
inline constexpr int optimized_light_size = 32;

/// What the model stands in now: the light that is optimised, or the first of the scene's. No
/// graph.
EnvironmentLight light_as_it_is(const EditScene& scene, const EditState& state);

/// Fits a field to the input's materials, or takes everything from the checkpoint in the output
/// folder when the request says resume and one is there.
EditState begin_or_resume(const EditRequest& request, const EditScene& scene);

/// Prepares the stage's state at the field as it is.
void begin_detail(EditState& state);

/// Iterations of the loop and views of the detail stage.
std::int64_t total_iterations(const EditSettings& settings);

/// Runs the remaining iterations, or as many as the edit takes to settle; writes checkpoints and
/// previews as it goes. Throws Interrupted after writing the checkpoint.
IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state);

/// What guidance leaves out. Its gradient is an average over noises, and an average has no grain: a
/// small prior's edit ends in the right colour, shine and metal, as smooth as before. So the prior
/// then samples, view after view (painting_plan.h): a picture of the model is noised, denoised with
/// the target sentence where no earlier view has painted, and the field's base colour is fitted to
/// it (TEXTure, Richardson et al. 2023, in a neural texture). Close-ups then refine all of it by
/// SDEdit's sampling (Meng et al. 2022). All other channels stay as guidance left them.
/// Does nothing unless wants_detail(settings). Throws as optimize.
void add_detail(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
