// Options of several commands that load a model.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <vector>

namespace item3d {

/// Adds the option --textures.
inline void add_texture_folders(CLI::App& command, std::vector<std::filesystem::path>& folders) {
    command
        .add_option("--textures", folders,
                    "Additional folder, with subfolders, in which textures are searched")
        ->type_name("FOLDER")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace item3d
