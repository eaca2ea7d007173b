// Several edits of one model as looks of one file (KHR_materials_variants).
#pragma once

#include "item3d/provenance/signing.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct VariantsRequest {
    std::filesystem::path model;                         ///< that was edited
    std::vector<std::filesystem::path> edits;            ///< folders that item3d edit left
    std::vector<std::string> names;                      ///< one for each edit; empty: see names_of
    std::string original;                                ///< empty: "original"
    std::filesystem::path output;                        ///< .glb or .gltf
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    bool says_provenance = true;
    std::shared_ptr<const SigningKey> sign_key;  ///< null: the result is not signed
};

/// A name for each target sentence, without the article that it begins with; `taken` ones and
/// equal ones get a number.
std::vector<std::string> variant_names_of(const std::vector<std::string>& sentences,
                                          std::vector<std::string> taken);

/// Writes the model with the look of each edit as a variant; what it shows by itself stays as it
/// is, and is the first new variant unless the model has variants already. Vertices are there once
/// (merge_variants.h), textures once for each content. Returns "model", "output" and "variants",
/// each with "name", "folder", "from", "to" (null for the model's own). Throws InputError for
/// folders of other models, edits that cannot share vertices, and names that are not unique.
nlohmann::json write_variants(const VariantsRequest& request);

}  // namespace item3d
