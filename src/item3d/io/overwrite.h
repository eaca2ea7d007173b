// Refusal of outputs that would overwrite an input model or its files.
#pragma once

#include <filesystem>
#include <vector>

namespace item3d {

/// Throws InputError if a command that writes the model `result` would overwrite the model that it
/// reads. If both are .obj files, this includes the material library beside `result`.
void check_not_replaced(const std::filesystem::path& model, const std::filesystem::path& result);

/// Throws InputError if a command that writes images to the folder `written` could overwrite
/// textures of the model. These can be files that the model names, and files in one of the
/// texture_folders (LoadOptions) or, unless the model is a .glb or .vrm file, in the model's
/// folder. There are none if `written` does not exist.
void check_textures_not_replaced(const std::filesystem::path& model,
                                 const std::vector<std::filesystem::path>& texture_folders,
                                 const std::filesystem::path& written);

}  // namespace item3d
