// Output folders of simulated edits, with the files that item3d edit writes.
#pragma once

#include "item3d/core/digest.h"
#include "tests/support/gltf_quad.h"

namespace item3d::testing_support {

inline EditClaim claim_to(const std::string& sentence) {
    EditClaim claim;
    claim.from = "a red quad";
    claim.to = sentence;
    claim.date = "2026-11-27T15:04:05Z";
    return claim;
}

/// Saves the edited model, and an edit.json with the target sentence.
inline fs::path write_edit_folder(const fs::path& folder, const fs::path& source,
                                  const ModelEdit& edit, const std::string& to,
                                  const std::string& variant = "") {
    EditClaim claim = claim_to(to);
    claim.input_sha256 = sha256(read_bytes(source));
    fs::create_directories(folder);
    save_model(folder / "model.glb", load_model(source, {.variant = variant}), edit, {{claim}, {}});
    const std::string text = nlohmann::json{
        {"from", claim.from},
        {"to", to},
        {"claim", claim},
        {"settings",
         {{"variant", variant}}}}.dump();
    write_quickly(folder / "edit.json", Bytes(text.begin(), text.end()));
    return folder;
}

}  // namespace item3d::testing_support
