// Lights requested by the viewer: presets, the sky by the hour and uploaded ones, with changes.
#pragma once

#include "item3d/scene/image.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// Returns the value of a parameter of the address, or "": "rotate", "tilt", "exposure", "sun"
/// (AZIMUTH,ELEVATION[,STRENGTH]), "lit" (words), "tint" (#rrggbb), "hour" (of "sky"), as in
/// `item3d relight`.
using LightParameter = std::function<std::string(const std::string& name)>;

/// Returns a light. name: a preset, "sky", or another whose image is in `file`. width: maximum
/// width of the equirectangular image, which is halved down to it. Throws InputError for an unknown
/// light or invalid values.
Image requested_light(const std::string& name, int width, const LightParameter& parameter,
                      const std::filesystem::path& file);

}  // namespace item3d
