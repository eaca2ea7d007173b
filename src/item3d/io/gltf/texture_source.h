// Images of glTF textures, which extensions may offer in several formats. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Reads the name and the image of a texture. The image is the first readable one of those that
/// KHR_texture_basisu, EXT_texture_webp and the texture itself name, whatever its format. Throws
/// InputError if none is readable.
Texture read_texture_source(const SourceDocument& document, const GltfObject& texture);

/// Updates the lists of used and required extensions: lists the extensions for images that textures
/// use, and removes those that none uses. An extension is required if some texture has no image
/// without it.
void list_texture_extensions(Json& json);

}  // namespace item3d
