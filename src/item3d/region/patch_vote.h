// A region from a binary decision at points of the surface.
#pragma once

#include "item3d/region/surface_reading.h"

#include <memory>

namespace item3d {

/// Result of a vote in each patch of surface_patches.h, which makes the region's borders follow
/// those of the patches. A patch is included whole if most of its points are included; for a small
/// patch, a quarter of them suffices. A large patch that is partly included is cut along the
/// points.
struct PatchVote {
    std::unique_ptr<Selector> selector;
    double taken = 0;   ///< share of included points in all; invisible ones count as excluded
    double mean = 0;    ///< mean value of included points; 0 if there are none
    float highest = 0;  ///< largest value of visible points
    at::Tensor inside;  ///< [K] bool: included points
};

/// value: [K] values at the reading's points. A point is included if it is visible and its value is
/// above `threshold`.
PatchVote vote_by_patch(const RegionScene& scene, const SurfaceReading& reading,
                        const at::Tensor& value, float threshold);

}  // namespace item3d
