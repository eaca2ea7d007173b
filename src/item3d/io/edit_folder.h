// Reading of an edit's output folder: the edited model and its description.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct EditFolder {
    std::filesystem::path folder;
    std::filesystem::path model;  ///< model.glb or model.vrm
    std::string from, to;         ///< the two sentences; for a plan, those of its last edit
    std::string variant;          ///< name of the edited variant; empty for the default
    /// SHA-256 of the edited model, and of the models from which the edited model was made.
    std::vector<std::string> inputs;
};

/// Reads the folder's edit.json, and for a plan also the edit.json files of its edits. Throws
/// InputError if the folder is not that of an edit, or the edit is unfinished.
EditFolder read_edit_folder(const std::filesystem::path& folder);

}  // namespace item3d
