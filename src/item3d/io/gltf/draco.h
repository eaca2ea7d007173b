// KHR_draco_mesh_compression: primitives whose vertices and triangles are one compressed mesh.
// Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

namespace item3d {

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// True if a primitive's vertices or indices exist only in compressed form (files may have an
/// uncompressed copy as a fallback).
bool needs_draco(const SourceDocument& document, const GltfObject& primitive);

/// Decompresses a primitive for which needs_draco() is true into document.decoded_accessors; does
/// nothing if that was done before. Checks the result against the primitive's accessors, and its
/// memory against the size of the file. Throws InputError.
void decode_draco_primitive(SourceDocument& document, const GltfObject& primitive);

/// Updates the attributes in a primitive's Draco extension to match those of the primitive, which
/// was `original` before.
void match_draco(const Json& original, Json& primitive);

}  // namespace item3d
