// Protection of an input model against a command's own output.
#pragma once

#include <filesystem>

namespace item3d {

/// Throws InputError if the model lies in the command's output folder, or in "textures" below it,
/// and is named "model", or has its textures in files of their own. The command could overwrite
/// the model or its textures.
void check_outside_output(const std::filesystem::path& model, const std::filesystem::path& output);

}  // namespace item3d
