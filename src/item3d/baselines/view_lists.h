// From where the published methods look at a model.
#pragma once

#include "item3d/baselines/painting_scene.h"

#include <vector>

namespace item3d {

/// TEXTure's ten, in its order: eight around the model, 30 degrees above, turning away from the
/// front on both sides; then from above and from below, behind.
const std::vector<ViewAngles>& ring_and_poles();

/// Text2Tex's ten principal views: the same ring, 15 degrees above, and both poles.
const std::vector<ViewAngles>& principal_views();
/// Text2Tex's 36 candidates for automatic refinement: twelve azimuths, three elevations.
const std::vector<ViewAngles>& candidate_views();

/// SyncMVD's ten: eight every 45 degrees at the model's height, two from above.
const std::vector<ViewAngles>& synchronized_views();

/// The first `count` of a list; all for 0.
std::vector<ViewAngles> first_views(const std::vector<ViewAngles>& views, int count);

}  // namespace item3d
