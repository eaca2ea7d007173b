// What a light is like, in numbers that people can use.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

#include <optional>
#include <vector>

namespace item3d {

/// A direction as people say it, in degrees: azimuth 0 is north (-Z, the centre of an
/// equirectangular map), 90 east (+X), in [0, 360); elevation is 90 at the zenith (+Y).
struct SkyAngles {
    float azimuth = 0;
    float elevation = 0;
};
Vec3 to_direction(SkyAngles angles);
SkyAngles to_sky_angles(Vec3 direction);

/// Rec. 709 luminance of linear RGB.
double luminance(glm::dvec3 rgb);

/// The connected texels around the brightest one that have at least a tenth of its luminance: a
/// sun's disk with most of its rim.
struct LightLobe {
    Vec3 direction{0, 1, 0};   ///< mean by energy, unit
    glm::dvec3 irradiance{0};  ///< on a plane that faces it, seen as small
    double solid_angle = 0;    ///< steradians
    double share = 0;          ///< of the energy of the whole light, in [0, 1]
    std::vector<bool> texels;  ///< row by row: which belong to it

    /// Of a disk of the same solid angle, radians.
    double radius() const;
    /// Small and strong enough to be a sun: at most 5 degrees in radius, 3 % of the energy.
    bool is_sun() const;
};

/// light: height x width x 3, equirectangular. A black light has a lobe of no energy.
LightLobe brightest_lobe(const Image& light);

struct LightDescription {
    /// Mean direction by energy, and how much it rules: 0 the same from all sides, 1 one direction.
    Vec3 dominant_direction{0, 1, 0};
    double directionality = 0;
    LightLobe lobe;
    glm::dvec3 mean_radiance{0};  ///< over the sphere, linear RGB
    /// Correlated colour temperature of the mean radiance in kelvin (McCamy 1992); none where that
    /// is not between 1000 and 40000, or for black.
    std::optional<double> color_temperature;
    /// Stops between the brightest texel and the first percentile of the sphere; none where that is
    /// black.
    std::optional<double> dynamic_range;
    double peak_irradiance_over_pi = 0;
};

LightDescription describe_light(const Image& light);

/// Over the sphere, linear RGB.
glm::dvec3 mean_radiance(const Image& light);

/// The radiance, mean of the three channels, of a white Lambertian surface that faces the light as
/// it is lit most.
float peak_irradiance_over_pi(const Image& light);

}  // namespace item3d
