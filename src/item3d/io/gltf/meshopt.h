// EXT_meshopt_compression: compressed buffer views. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

namespace item3d {

/// Decompresses every buffer view with the extension into document.decoded_views. Checks declared
/// sizes against the compressed bytes before allocating. Throws InputError.
void decode_meshopt_views(SourceDocument& document);

}  // namespace item3d
