// The folder that an edit leaves, as far as its model is concerned.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct EditFolder {
    std::filesystem::path folder;
    std::filesystem::path model;  ///< model.glb or model.vrm
    std::string from, to;         ///< of a plan, of its last edit
    std::string variant;          ///< the look that was edited; empty: what the model shows
    /// SHA-256 of the model that was edited, and of those that it was made of itself.
    std::vector<std::string> inputs;
};

/// Reads edit.json, and of a plan those of its edits. Throws InputError for a folder that no edit
/// left, or one that is not done.
EditFolder read_edit_folder(const std::filesystem::path& folder);

}  // namespace item3d
