// A region from points of the surface, each of which belongs to it or does not.
#pragma once

#include "item3d/region/surface_reading.h"

#include <memory>

namespace item3d {

/// A vote by the pieces of surface_patches.h, so that borders are the model's own: one is taken
/// whole where most of its points are in, a small one where a quarter of them is; a large one that
/// is in part in is cut where the points say.
struct PatchVote {
    std::unique_ptr<Selector> selector;
    double taken = 0;   ///< part of the points that are in, unseen ones counted as out
    double mean = 0;    ///< value of those that are in, on average; 0 where none is
    float highest = 0;  ///< value of any point that is seen
    at::Tensor inside;  ///< [K] bool: the points that are in
};

/// value: [K] of the reading's points; a point is in where it is above `threshold` and seen.
PatchVote vote_by_patch(const RegionScene& scene, const SurfaceReading& reading,
                        const at::Tensor& value, float threshold);

}  // namespace item3d
