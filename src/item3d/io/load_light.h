// Loading of lights by name or from files, with validation of their values.
#pragma once

#include "item3d/lighting/layout.h"
#include "item3d/scene/image.h"

#include <string>

namespace item3d {

/// Loads a preset by name, or a file: .hdr and .exr; .png and .jpg, which are interpreted as sRGB
/// with a warning; or the image-based light of a .glb or .gltf (EXT_lights_image_based). Returns
/// three channels, equirectangular. Negative values and NaN become 0, with a warning. Infinite
/// values become the largest finite value of the image (at least 65504), with a warning. Throws
/// InputError for unreadable files, for images that are mostly NaN, and for black ones.
Image load_light(const std::string& name_or_path, LightLayout layout = LightLayout::automatic);

}  // namespace item3d
