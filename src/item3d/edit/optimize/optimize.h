// The loop: cameras -> render -> guidance -> backward -> step.
#pragma once

#include "item3d/edit/request.h"
#include "item3d/edit/scene.h"
#include "item3d/edit/state.h"

#include <cstdint>

namespace item3d {

/// Sums over the iterations that this run did, in seconds.
struct IterationTimes {
    std::int64_t iterations = 0;
    double render = 0;
    double encode = 0;
    double unet = 0;
    double backward = 0;
    double step = 0;
    double adjust = 0;    ///< pictures and captions of DirectionAdjustment
    double exchange = 0;  ///< with other processes, waiting included; a part of the others
};

/// Runs the remaining iterations, or as many as the edit takes to converge; writes checkpoints and
/// previews as it goes. Throws Interrupted after writing the checkpoint.
IterationTimes optimize(const EditRequest& request, const EditScene& scene, EditState& state);

}  // namespace item3d
