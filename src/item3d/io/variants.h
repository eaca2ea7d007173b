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
    std::filesystem::path model;               ///< the unedited model
    std::vector<std::filesystem::path> edits;  ///< folders of item3d edit
    /// One for each edit; if empty, variant_names_of() makes the names.
    std::vector<std::string> names;
    /// Name of the variant that shows the unedited model. If it is empty, a model without variants
    /// gets "original", and a model with variants gets no such variant.
    std::string original;
    std::filesystem::path output;                        ///< .glb or .gltf
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    bool says_provenance = true;
    std::shared_ptr<const SigningKey> sign_key;  ///< null for an unsigned result
};

/// Returns a variant name for each target sentence: the sentence without its leading article. A
/// name that is `taken` or repeated gets a number.
std::vector<std::string> variant_names_of(const std::vector<std::string>& sentences,
                                          std::vector<std::string> taken);

/// Writes the model with each edit as a variant. The default look stays unchanged. It also becomes
/// the first new variant, unless the model already has variants and `original` is empty. Vertices
/// are stored once (merge_variants.h), and so are equal textures. Returns an object with "model",
/// "output" and "variants". Each variant has "name", "folder", "from" and "to"; that of the
/// unedited model has no "from", and null for "folder" and "to". Throws InputError for folders of
/// other models, edits that cannot share vertices, and names that are not unique.
nlohmann::json write_variants(const VariantsRequest& request);

}  // namespace item3d
