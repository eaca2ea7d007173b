// Removal of textures that an edit has made unused. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"

namespace item3d {

/// Removes from `builder`'s JSON, a patched copy of document.json, the textures that materials used
/// before and no longer use. Also removes the images and buffer views that served only these
/// textures, and the views' bytes from the builder's buffer. Updates indices. Keeps textures that
/// were unused before. Removes nothing if the document has unknown extensions, which may refer to
/// textures.
void remove_unused_textures(const SourceDocument& document, GltfBuilder& builder);

}  // namespace item3d
