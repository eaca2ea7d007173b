// Manual adjustments of a light.
#pragma once

#include "item3d/core/math.h"
#include "item3d/lighting/description.h"

#include <optional>

namespace item3d {

/// Turns the light about the X axis (west to east) by `degrees`. A positive angle raises the north
/// (-Z, the map's centre).
Image tilt_light(const Image& light, float degrees);

/// Multiplies the light by a colour (linear RGB) that is normalised to luminance 1, so that a tint
/// does not darken. Throws InputError for black.
Image tint_light(const Image& light, Vec3 linear_color);

/// Returns the light with `lobe` and its blurred rim replaced by the mean of a ring around it.
Image without_lobe(const Image& light, const LightLobe& lobe);

struct SunSetting {
    SkyAngles from;
    /// Irradiance on a surface that faces the sun, relative to the mean irradiance of the rest of
    /// the light. Without a value, the light's own sun keeps its irradiance, and a new sun has a
    /// strength of 6.
    std::optional<float> strength;
    /// Diameter in degrees (0.53 for the true sun). The irradiance does not depend on it.
    float width = 3;
};

/// Moves the light's sun to `setting.from`, or adds a white sun there if the light has none. The
/// light's sun is its brightest lobe, if LightLobe::is_sun() says so. Its old place is filled from
/// its surroundings. The result is scaled so that the brightest white surface keeps its brightness.
Image place_sun(const Image& light, const SunSetting& setting);

/// Adjustments of a light.
struct LightChange {
    float rotation = 0;  ///< degrees
    float tilt = 0;      ///< degrees
    float exposure = 0;  ///< stops
    std::optional<SunSetting> sun;
    std::optional<Vec3> tint;  ///< linear RGB
};

/// Returns the light after rotation, tilt, placement of the sun, tint and exposure, in this order.
/// So the sun's direction is the final one, and tint and exposure apply to the whole light.
Image change_light(const Image& light, const LightChange& change);

}  // namespace item3d
