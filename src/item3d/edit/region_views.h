// Close-up cameras of a model's edited region.
#pragma once

#include "item3d/region/region.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Cameras that face points of a region nearly head-on. They are so close that a small part fills
/// the image.
class RegionViews {
  public:
    /// Throws InputError if no point of the region is visible from outside.
    RegionViews(const RegionPoints& points, const Model& model, const Geometry& geometry);

    /// Replaces every second camera of an iteration by a close-up. If an iteration has only one
    /// camera, replaces the camera of every second iteration. The other cameras show the whole
    /// model.
    void take_turns(std::vector<Camera>& cameras, std::uint64_t seed, std::int64_t iteration) const;

  private:
    struct Look {
        Vec3 target;
        Vec3 direction;  ///< unit vector from target to camera
        float radius;    ///< radius of the visible area around the target
    };
    Camera camera(const Look& look, std::uint64_t seed, std::int64_t iteration) const;

    std::vector<Look> looks_;
    float model_radius_;
};

}  // namespace item3d
