// Models and documents to .glb and .gltf files. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"
#include "item3d/io/save.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <functional>

namespace item3d {

/// .glb or .gltf: the model's own document patched, or a new one.
void write_gltf(const std::filesystem::path& path, const Model& model, const ModelEdit& edit,
                const Provenance& provenance);

/// A document as `patch` changes it, written as .glb or .gltf.
void write_patched(const std::filesystem::path& path, const SourceDocument& document,
                   const std::function<void(GltfBuilder&)>& patch, const Provenance& provenance);

/// The .glb with a claim of `provenance`, which has hashes of what is in it; as it is where that
/// says nothing. source: the document before it was edited.
Bytes claimed_glb(const std::filesystem::path& path, const Bytes& glb, const SourceDocument& source,
                  const Provenance& provenance);

/// `json` and the BIN chunk (none where `binary` is empty), with the other chunks of `document`.
/// Throws InputError where that is more than a .glb can hold.
Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document);

}  // namespace item3d
