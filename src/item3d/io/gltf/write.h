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

/// Writes a .glb or .gltf. For a model from a glTF it is the patched document, for other models a
/// new one.
void write_gltf(const std::filesystem::path& path, const Model& model, const ModelEdit& edit,
                const Provenance& provenance);

/// Writes a document, changed by `patch`, as .glb or .gltf.
void write_patched(const std::filesystem::path& path, const SourceDocument& document,
                   const std::function<void(GltfBuilder&)>& patch, const Provenance& provenance);

/// Returns the .glb with a claim that describes `provenance` and contains hashes of the content.
/// Returns it unchanged if `provenance` is empty. source: the document before the edit.
Bytes claimed_glb(const std::filesystem::path& path, const Bytes& glb, const SourceDocument& source,
                  const Provenance& provenance);

/// Returns a .glb with `json`, the BIN chunk `binary` (unless that is empty), and the chunks of
/// `document` of other types. Throws InputError if the result exceeds a .glb's capacity.
Bytes to_glb(const Json& json, const Bytes& binary, const SourceDocument& document);

}  // namespace item3d
