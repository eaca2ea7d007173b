// The loop: cameras -> render -> guidance -> backward -> step.
#pragma once

#include "item3d/edit/edit.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/timing.h"
#include "item3d/field/adam.h"
#include "item3d/field/neural_texture.h"
#include "item3d/guidance/guidance.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Everything that an edit changes; what a checkpoint holds.
struct EditState {
    NeuralTexture fitted{nullptr};  ///< the field as fitted to the input, for the bake's residual
    NeuralTexture field{nullptr};
    Adam optimizer;
    std::unique_ptr<Guidance> guidance;
    std::int64_t iteration = 0;           ///< iterations done
    std::vector<float> direction_length;  ///< a curve of the report, one value an iteration
    std::vector<float> adjustment_loss;
};

/// Fits a field to the input's materials, or takes everything from the checkpoint in the output
/// folder when the request says resume and one is there.
EditState begin_or_resume(const EditRequest& request, const EditScene& scene);

/// Runs the remaining iterations; writes checkpoints and previews as it goes. Throws Interrupted
/// after writing the checkpoint.
IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
