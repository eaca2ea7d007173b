// The views of the published methods.
#pragma once

#include "item3d/baselines/painting_scene.h"

#include <vector>

namespace item3d {

/// Returns TEXTure's ten views, in its order: eight around the model, 30 degrees above, alternating
/// from the front to both sides; then from above and from below, at the back.
const std::vector<ViewAngles>& ring_and_poles();

/// Returns Text2Tex's ten principal views: the ring of ring_and_poles(), but 15 degrees above, and
/// both poles.
const std::vector<ViewAngles>& principal_views();
/// Returns Text2Tex's 36 candidates for automatic refinement: twelve azimuths, three elevations.
const std::vector<ViewAngles>& candidate_views();

/// Returns SyncMVD's ten views: eight every 45 degrees at the model's height, two from above.
const std::vector<ViewAngles>& synchronized_views();

/// Returns the first `count` of a list; all for 0.
std::vector<ViewAngles> first_views(const std::vector<ViewAngles>& views, int count);

}  // namespace item3d
