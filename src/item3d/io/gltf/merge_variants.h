// Edited copies of a glTF document as looks of one (KHR_materials_variants). Internal to io.
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
    std::string name;  ///< of the look that it becomes
    std::string look;  ///< the variant of it that the edit shows; empty: what it shows by itself
};

/// Makes `builder`'s JSON, a copy of document.json, offer the look of every edited copy as a
/// variant behind those that it has. original: name of a variant for what it shows by itself;
/// empty: none is made. Vertices and triangles stay as they are, but where edits gave a primitive
/// the same new UV map: then that is everyone's, and the source's textures follow to where their
/// own coordinates went. Throws InputError for a document that is no edited copy, and where UV maps
/// of edits differ.
void merge_variants(const SourceDocument& document, const std::vector<EditedDocument>& edits,
                    const std::string& original, GltfBuilder& builder);

}  // namespace item3d
