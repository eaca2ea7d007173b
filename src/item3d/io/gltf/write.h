// Models and documents to .glb and .gltf files. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <filesystem>

namespace item3d {

/// .glb or .gltf: the model's own document patched, or a new one.
void write_gltf(const std::filesystem::path& path, const Model& model, const ModelEdit& edit);

/// `json` and the BIN chunk (none where `binary` is empty), with the other chunks of `document`.
/// Throws InputError where that is more than a .glb can hold.
Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document);

}  // namespace item3d
