// Lights that the viewer requests: presets, the sky by the hour, and uploaded lights, each with
// changes.
#pragma once

#include "item3d/scene/image.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// Returns the value of a parameter of the request's URL, or "". The parameters are "rotate",
/// "tilt", "exposure", "sun" (AZIMUTH,ELEVATION[,STRENGTH]), "lit" (words), "tint" (#rrggbb) and
/// "hour" (for the light "sky"), as in `item3d relight`.
using LightParameter = std::function<std::string(const std::string& name)>;

/// Returns a light. name: a preset, "sky", or an uploaded light, whose image is in `file`. width:
/// maximum width of the equirectangular image; a wider image is halved repeatedly. Throws
/// InputError for an unknown light or invalid values.
Image requested_light(const std::string& name, int width, const LightParameter& parameter,
                      const std::filesystem::path& file);

}  // namespace item3d
