// The meshes that the embedded prior's edits are judged on.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace item3d {

/// Writes airplane, duck, rabbit, sofa, teapot and truck, each the first variant that training data
/// never has (prior/shapes.h), as `folder`/NOUN.glb without materials or UVs. Returns the files by
/// noun. Rabbit, sofa and teapot are classes that it has nothing of.
std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder);

}  // namespace item3d
