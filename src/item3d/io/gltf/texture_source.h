// The pictures of a glTF's textures, of which extensions may name several. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

namespace item3d {

/// Name and picture of a texture: the first that can be read of KHR_texture_basisu's,
/// EXT_texture_webp's and its own, whatever format each is in. Throws InputError where none can be.
Texture read_texture_source(const SourceDocument& document, const GltfObject& texture);

/// Makes the texture extensions in the lists of used and required extensions those that textures
/// have; required: those of which some texture has no other picture.
void list_texture_extensions(Json& json);

}  // namespace item3d
