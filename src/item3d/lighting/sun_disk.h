// The drawing of a sun, or any distant round lamp, into an equirectangular light.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

struct SunDisk {
    Vec3 direction{0, 1, 0};    ///< unit, towards the disk's centre
    float radius = 0.0349f;     ///< radians; the irradiance does not depend on it
    glm::dvec3 irradiance{1};   ///< on a plane perpendicular to `direction`
    bool above_horizon = true;  ///< true if the disk is clipped at the horizon
};

/// Adds the disk to `light` (height x width x 3). A disk smaller than a texel fills a texel.
void add_sun_disk(Image& light, const SunDisk& disk);

}  // namespace item3d
