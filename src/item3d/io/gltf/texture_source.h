// Images of glTF textures, which extensions may offer in several formats. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Reads name and image of a texture: the first readable one of KHR_texture_basisu's,
/// EXT_texture_webp's and its own, whatever their formats. Throws InputError where none is
/// readable.
Texture read_texture_source(const SourceDocument& document, const GltfObject& texture);

/// Sets the lists of used and required extensions to those that textures use; required: extensions
/// without which some texture has no image.
void list_texture_extensions(Json& json);

}  // namespace item3d
