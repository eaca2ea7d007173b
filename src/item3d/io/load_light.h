// Lights by name and from files, brought to what the rest of the program takes for granted.
#pragma once

#include "item3d/lighting/layout.h"
#include "item3d/scene/image.h"

#include <string>

namespace item3d {

/// A preset by name, or a file: .hdr and .exr; .png and .jpg, which are taken as sRGB with a
/// warning; or the image-based light of a .glb or .gltf (EXT_lights_image_based). Three channels,
/// equirectangular. Negative values and values that are no numbers become 0, infinite ones those of
/// the brightest pixel (65504 at least), with a warning. Throws InputError for what cannot be read,
/// for pictures that are for the most part no numbers, or black all over.
Image load_light(const std::string& name_or_path, LightLayout layout = LightLayout::automatic);

}  // namespace item3d
