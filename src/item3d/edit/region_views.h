// Close-ups of the part of a model that is edited.
#pragma once

#include "item3d/region/region.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Cameras that see places of a region from about straight ahead, near enough that a small part
/// fills the picture.
class RegionViews {
  public:
    /// Throws InputError where no place of the region can be seen from outside.
    RegionViews(const RegionPoints& points, const Model& model, const Geometry& geometry);

    /// Exchanges every other of an iteration's cameras (of one, every other iteration's) for a
    /// close-up; the rest keeps the whole in context.
    void take_turns(std::vector<Camera>& cameras, std::uint64_t seed, std::int64_t iteration) const;

  private:
    struct Look {
        Vec3 target;
        Vec3 direction;  ///< from there to the camera, unit
        float radius;    ///< of what is to be seen around the target
    };
    Camera camera(const Look& look, std::uint64_t seed, std::int64_t iteration) const;

    std::vector<Look> looks_;
    float model_radius_;
};

}  // namespace item3d
