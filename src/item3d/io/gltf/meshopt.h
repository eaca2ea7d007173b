// EXT_meshopt_compression: buffer views that hold compressed bytes. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

namespace item3d {

/// Decompresses every buffer view with the extension into document.decoded_views. What a view
/// declares is checked against its compressed bytes before memory is taken. Throws InputError.
void decode_meshopt_views(SourceDocument& document);

}  // namespace item3d
