// Lights as the viewer asks for them: presets, the sky by the hour and uploaded ones, changed.
#pragma once

#include "item3d/scene/image.h"

#include <filesystem>
#include <functional>
#include <string>

namespace item3d {

/// The value of a parameter of the address, or nothing: "rotate", "tilt", "exposure", "sun"
/// (AZIMUTH,ELEVATION[,STRENGTH]), "lit" (words), "tint" (#rrggbb), "hour" (of "sky"), as
/// `item3d relight` has them.
using LightParameter = std::function<std::string(const std::string& name)>;

/// name: a preset, "sky", or another whose picture is in `file`. width: of the equirectangular
/// picture; pictures are halved until they are no wider. Throws InputError for a light that there
/// is not, and for values that cannot be understood.
Image requested_light(const std::string& name, int width, const LightParameter& parameter,
                      const std::filesystem::path& file);

}  // namespace item3d
