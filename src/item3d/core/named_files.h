// Names of the files that a model's file refers to.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Returns the names of the buffers and images of a .gltf, or of the material libraries of an .obj
/// and the images of these libraries. Names are relative to the model's folder and may denote files
/// that do not exist. Returns nothing for other files, whose data are inside.
std::vector<std::string> files_named_by(const std::filesystem::path& model);

}  // namespace item3d
