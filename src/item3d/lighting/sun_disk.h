// A sun, or any round lamp far away, drawn into an equirectangular light.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

struct SunDisk {
    Vec3 direction{0, 1, 0};    ///< unit, towards its centre
    float radius = 0.0349f;     ///< radians; its irradiance does not depend on it
    glm::dvec3 irradiance{1};   ///< on a plane that faces it
    bool above_horizon = true;  ///< what would be below the horizon is left out
};

/// Adds the disk to `light` (height x width x 3). One that is smaller than a texel fills a texel.
void add_sun_disk(Image& light, const SunDisk& disk);

}  // namespace item3d
