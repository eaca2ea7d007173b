// KHR_draco_mesh_compression: primitives whose vertices and triangles are one compressed mesh.
// Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

namespace item3d {

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// Whether a primitive's vertices or indices are in compressed data alone (files may carry a plain
/// copy for readers that cannot decompress).
bool needs_draco(const SourceDocument& document, const GltfObject& primitive);

/// Decompresses such a primitive into document.decoded_accessors; does nothing the second time.
/// What comes out is checked against the primitive's accessors, what it takes against the size of
/// the file. Throws InputError.
void decode_draco_primitive(SourceDocument& document, const GltfObject& primitive);

/// Compressed attributes are named twice, in a primitive and in its Draco extension: makes those of
/// the extension agree with those of the primitive, which was `original` before.
void match_draco(const Json& original, Json& primitive);

}  // namespace item3d
