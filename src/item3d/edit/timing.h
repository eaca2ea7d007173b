// Where an edit's time goes, for edit.json.
#pragma once

#include "item3d/core/stage_times.h"

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
    double adjust = 0;  ///< pictures and captions of DirectionAdjustment
};

}  // namespace item3d
