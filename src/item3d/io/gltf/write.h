// The .glb container. Internal to scene/io.
#pragma once

#include "item3d/io/gltf/document.h"

namespace item3d {

/// `json` and the BIN chunk (none where `binary` is empty), with the other chunks of `document`.
/// Throws InputError where that is more than a .glb can hold.
Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document);

}  // namespace item3d
