// The optimisation loop: cameras -> render -> guidance -> backward -> step.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <cstdint>

namespace item3d {

/// The total seconds that this run's iterations took, by stage.
struct IterationTimes {
    std::int64_t iterations = 0;
    double render = 0;
    double encode = 0;
    double unet = 0;
    double backward = 0;
    double step = 0;
    double adjust = 0;    ///< images and captions of DirectionAdjustment
    double exchange = 0;  ///< exchange between processes and waiting; included in the times above
};

/// Runs the remaining iterations, or fewer if the edit converges. Writes checkpoints and previews
/// between iterations. If interrupted, writes the checkpoint and throws Interrupted.
IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
