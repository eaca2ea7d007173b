// The merge of several edits of one model into one file with variants (KHR_materials_variants).
#pragma once

#include "item3d/provenance/signing.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct VariantsRequest {
    std::filesystem::path model;                         ///< the unedited model
    std::vector<std::filesystem::path> edits;            ///< folders of item3d edit
    std::vector<std::string> names;                      ///< by edit; empty: variant_names_of()
    std::string original;                                ///< empty: "original"
    std::filesystem::path output;                        ///< .glb or .gltf
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    bool says_provenance = true;
    std::shared_ptr<const SigningKey> sign_key;  ///< null: the result is not signed
};

/// Returns a name for each target sentence, without its leading article; names that are `taken` or
/// equal get a number.
std::vector<std::string> variant_names_of(const std::vector<std::string>& sentences,
                                          std::vector<std::string> taken);

/// Writes the model with each edit as a variant; the default stays unchanged, and becomes the first
/// new variant unless the model has variants already. Vertices are stored once (merge_variants.h),
/// textures once for each content. Returns "model", "output" and "variants", each with "name",
/// "folder", "from", "to" (null for variants of the model itself). Throws InputError for folders of
/// other models, edits that cannot share vertices, and names that are not unique.
nlohmann::json write_variants(const VariantsRequest& request);

}  // namespace item3d
