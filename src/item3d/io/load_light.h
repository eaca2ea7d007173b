// Loading of lights by name or from files, with validation of their values.
#pragma once

#include "item3d/lighting/layout.h"
#include "item3d/scene/image.h"

#include <string>

namespace item3d {

/// Loads a preset by name, or a light from a file. The file is an image in .hdr or .exr, or in .png
/// or .jpg, which is interpreted as sRGB with a warning, or it is a .glb or .gltf with an
/// image-based light (EXT_lights_image_based). Returns an equirectangular image of three channels.
/// Negative values and NaN become 0, with a warning. Infinite values become the largest finite
/// value of the image (at least 65504), with a warning. Throws InputError for unreadable files, for
/// images that are mostly NaN, and for black images.
Image load_light(const std::string& name_or_path, LightLayout layout = LightLayout::automatic);

}  // namespace item3d
