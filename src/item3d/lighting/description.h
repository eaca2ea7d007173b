// The description of a light in numbers that people can read.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>
#include <vector>

namespace item3d {

/// A direction in degrees. The azimuth is in [0, 360): 0 is north (-Z, the centre of an
/// equirectangular map), 90 is east (+X). The elevation is 90 at the zenith (+Y).
struct SkyAngles {
    float azimuth = 0;
    float elevation = 0;
};
Vec3 to_direction(SkyAngles angles);
SkyAngles to_sky_angles(Vec3 direction);

/// Returns the Rec. 709 luminance of linear RGB.
double luminance(glm::dvec3 rgb);

/// The texels that are connected to the brightest texel and have at least a tenth of its luminance.
/// For a sun these are its disk and most of its rim.
struct LightLobe {
    Vec3 direction{0, 1, 0};   ///< energy-weighted mean, unit
    glm::dvec3 irradiance{0};  ///< of a plane that faces the lobe, all cosines taken as 1
    double solid_angle = 0;    ///< steradians
    double share = 0;          ///< share of the whole light's energy, in [0, 1]
    std::vector<bool> texels;  ///< row by row; true for texels in the lobe

    /// Returns the radius, in radians, of a disk of the same solid angle.
    double radius() const;
    /// True if the lobe may be a sun: at most 5 degrees in radius, at least 3 % of the energy.
    bool is_sun() const;
};

/// light: height x width x 3, equirectangular. A black light has a lobe without energy.
LightLobe brightest_lobe(const Image& light);

struct LightDescription {
    /// Energy-weighted mean direction, and its dominance: 0 for uniform light, 1 for a single
    /// direction.
    Vec3 dominant_direction{0, 1, 0};
    double directionality = 0;
    LightLobe lobe;
    glm::dvec3 mean_radiance{0};  ///< mean over the sphere, linear RGB
    /// Correlated colour temperature of the mean radiance in kelvin (McCamy 1992); no value outside
    /// of 1000 to 40000 K, or for a black light.
    std::optional<double> color_temperature;
    /// Stops between the brightest texel and the first percentile of luminance over the sphere; no
    /// value if that percentile is black.
    std::optional<double> dynamic_range;
    double peak_irradiance_over_pi = 0;
};

LightDescription describe_light(const Image& light);

/// Returns the mean radiance over the sphere, linear RGB.
glm::dvec3 mean_radiance(const Image& light);

/// Returns the largest radiance, as the mean of the three channels, of a white Lambertian surface
/// in any orientation.
float peak_irradiance_over_pi(const Image& light);

}  // namespace item3d
