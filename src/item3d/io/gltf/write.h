// Writing of models and documents to .glb and .gltf files. Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"
#include "item3d/io/save.h"
#include "item3d/provenance/provenance.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <functional>

namespace item3d {

/// Writes a .glb or .gltf: the patched document of a model from glTF, a new document for other
/// models.
void write_gltf(const std::filesystem::path& path, const Model& model, const ModelEdit& edit,
                const Provenance& provenance);

/// Writes a document, changed by `patch`, as .glb or .gltf.
void write_patched(const std::filesystem::path& path, const SourceDocument& document,
                   const std::function<void(GltfBuilder&)>& patch, const Provenance& provenance);

/// Returns the .glb with a claim of `provenance`, which contains hashes of the content; unchanged
/// for empty provenance. source: the document before the edit.
Bytes claimed_glb(const std::filesystem::path& path, const Bytes& glb, const SourceDocument& source,
                  const Provenance& provenance);

/// Returns a .glb of `json` and the BIN chunk (none where `binary` is empty), with the other chunks
/// of `document`. Throws InputError where that exceeds a .glb's capacity.
Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document);

}  // namespace item3d
