// Protection of an input model and its textures against a command's own output.
#pragma once

#include <filesystem>
#include <vector>

namespace item3d {

/// Throws InputError if a command that writes `result` would replace the model that it reads.
void check_not_replaced(const std::filesystem::path& model, const std::filesystem::path& result);

/// Throws InputError if a command that writes images to the folder `written` could replace textures
/// of the model. These can lie in one of the texture_folders (LoadOptions) and, unless the model is
/// a .glb or .vrm file, in the model's folder. An output folder without `written` has none.
void check_textures_not_replaced(const std::filesystem::path& model,
                                 const std::vector<std::filesystem::path>& texture_folders,
                                 const std::filesystem::path& written);

}  // namespace item3d
