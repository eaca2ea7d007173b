// The merge of edited copies of a glTF document as variants of one (KHR_materials_variants).
// Internal to io.
#pragma once

#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// An edited copy of the document.
struct EditedDocument {
    const SourceDocument* document = nullptr;
    std::string name;  ///< name of its new variant
    std::string look;  ///< variant of the copy to import; empty for the default
};

/// Adds every edited copy as a variant to `builder`'s JSON, a copy of document.json, after existing
/// variants. original: name of a variant for the document's default materials; empty for no such
/// variant. Vertices and triangles stay unchanged, except in a primitive to which edits gave a new
/// UV map. All variants then use the new map, and the source's textures use the moved coordinates.
/// Throws InputError for a document that is no edited copy, and if edits gave a primitive different
/// UV maps.
void merge_variants(const SourceDocument& document, const std::vector<EditedDocument>& edits,
                    const std::string& original, GltfBuilder& builder);

}  // namespace item3d
