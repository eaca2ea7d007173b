// The meshes that the embedded prior's edits are judged on.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace item3d {

/// Writes the first variant of a class of prior/shapes.h that training data never has, without
/// materials or UVs, as `folder`/NOUN.glb, and returns that.
std::filesystem::path save_held_out_mesh(const std::filesystem::path& folder,
                                         const std::string& noun);

/// Writes airplane, duck, rabbit, sofa, teapot and truck, as save_held_out_mesh(). Returns the
/// files by noun. Rabbit, sofa and teapot are classes that it has nothing of.
std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder);

}  // namespace item3d
