// Images of glTF textures, which extensions may offer in several formats. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Reads the name and the image of a texture. The image is the first readable one of those that
/// KHR_texture_basisu, EXT_texture_webp and the texture itself name, whatever its format. Throws
/// InputError if none is readable.
Texture read_texture_source(const SourceDocument& document, const GltfObject& texture);

/// Sets the lists of used and required extensions to those that textures use; required: extensions
/// without which some texture has no image.
void list_texture_extensions(Json& json);

}  // namespace item3d
