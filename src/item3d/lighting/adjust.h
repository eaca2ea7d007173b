// Changes of a light by hand.
#pragma once

#include "item3d/core/math.h"
#include "item3d/lighting/description.h"

#include <optional>

namespace item3d {

/// Turns the light about the X axis (west to east) by `degrees`; positive: what stood in the north
/// (-Z, the map's centre) rises.
Image tilt_light(const Image& light, float degrees);

/// Multiplies by a colour (linear RGB) that is brought to luminance 1 first, so that a tint does
/// not darken. Throws InputError for black.
Image tint_light(const Image& light, Vec3 linear_color);

/// The light with `lobe` and its blurred rim replaced by the mean of a ring around it.
Image without_lobe(const Image& light, const LightLobe& lobe);

struct SunSetting {
    SkyAngles from;
    /// Irradiance facing the sun over the mean irradiance of the rest of the light; none: what the
    /// light's own sun has, else 6.
    std::optional<float> strength;
    float width =
        3;  ///< degrees across; the true sun has 0.53. Its irradiance does not depend on it
};

/// Moves the light's sun, its brightest lobe where that is a sun (LightLobe::is_sun), to
/// `setting.from`; where there is none, adds a white one. The place where it stood is filled from
/// its surroundings. The whole is then scaled so that the brightest white surface is as bright as
/// before.
Image place_sun(const Image& light, const SunSetting& setting);

/// What can be changed of a light.
struct LightChange {
    float rotation = 0;  ///< degrees
    float tilt = 0;      ///< degrees
    float exposure = 0;  ///< stops
    std::optional<SunSetting> sun;
    std::optional<Vec3> tint;  ///< linear RGB
};

/// The light turned, tilted, given its sun, tinted and exposed, in this order: where a sun is asked
/// for is where it stands in the end, and tint and exposure are those of the whole.
Image change_light(const Image& light, const LightChange& change);

}  // namespace item3d
