// The optimisation loop: cameras -> render -> guidance -> backward -> step.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <cstdint>

namespace item3d {

/// Total seconds of this run's iterations, by stage.
struct IterationTimes {
    std::int64_t iterations = 0;
    double render = 0;
    double encode = 0;
    double unet = 0;
    double backward = 0;
    double step = 0;
    double adjust = 0;    ///< images and captions of DirectionAdjustment
    double exchange = 0;  ///< exchange between processes, waiting included; part of the times above
};

/// Runs the remaining iterations, or fewer where the edit converges. Writes checkpoints and
/// previews between iterations. Throws Interrupted after writing the checkpoint.
IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
