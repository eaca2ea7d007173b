// The views of the published methods.
#pragma once

#include "item3d/baselines/painting_scene.h"

#include <vector>

namespace item3d {

/// Returns TEXTure's ten views, in its order. The first eight are around the model, 30 degrees
/// above it, from the front alternately to both sides. The last two see the back from 60 degrees
/// above and from 60 degrees below.
const std::vector<ViewAngles>& ring_and_poles();

/// Returns Text2Tex's ten principal views: the first eight of ring_and_poles(), but 15 degrees
/// above the model, and one from near each pole.
const std::vector<ViewAngles>& principal_views();
/// Returns the 36 views from which Text2Tex's refinement chooses: twelve azimuths at each of three
/// elevations.
const std::vector<ViewAngles>& candidate_views();

/// Returns SyncMVD's ten views: eight at the model's height, every 45 degrees, and two from above.
const std::vector<ViewAngles>& synchronized_views();

/// Returns the first `count` views of a list; all views if `count` is 0.
std::vector<ViewAngles> first_views(const std::vector<ViewAngles>& views, int count);

}  // namespace item3d
