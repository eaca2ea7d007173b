// A clear sky from a physical model of the atmosphere: Rayleigh and Mie scattering and ozone in a
// spherical atmosphere. Single scattering is integrated along the ray (Nishita et al. 1993). All
// further orders use the isotropic approximation of Hillaire 2020 ("A Scalable and Production Ready
// Sky and Atmosphere Rendering Technique").
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

struct SkyOptions {
    Vec3 sun_direction{0, 1, 0};  ///< unit, towards the sun (or the moon), +Y up
    Vec3 sun_irradiance{1.0f};    ///< above the atmosphere, on a plane that faces the sun
    /// Amount of aerosol: 1 is clear air (visibility about 100 km), 5 is hazy.
    float haze = 1.0f;
    Vec3 ground_albedo{0.2f};
    /// Angular radius of the sun's disk, radians. The irradiance does not depend on it. The true
    /// sun (0.00465) would be a single texel that no prefiltered map can represent, so the disk is
    /// drawn larger.
    float sun_radius = 0.0349f;
};

/// Returns linear RGB radiance seen from near the ground, height x 2*height x 3 (conventions of
/// environment.h). Below the horizon is a Lambertian plain that this sky lights.
Image make_clear_sky(const SkyOptions& options, int height);

}  // namespace item3d
