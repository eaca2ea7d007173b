// Textures that nobody refers to any more once an edit brought others. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"

namespace item3d {

/// Removes from `builder`'s JSON, a patched copy of document.json, the textures that materials
/// referred to before and do not now, with images and buffer views that served them alone, and the
/// views' bytes from the builder's buffer. Indices follow. Textures that were unused before stay;
/// so does everything in documents with extensions that may refer to textures in ways that are not
/// known here.
void remove_unused_textures(const SourceDocument& document, GltfBuilder& builder);

}  // namespace item3d
