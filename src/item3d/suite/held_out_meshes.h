// Held-out meshes of the embedded prior's test edits.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace item3d {

/// Writes the first held-out variant of a class of prior/data/shapes/shapes.h, without materials or
/// UVs, as `folder`/NOUN.glb, and returns the path.
std::filesystem::path save_held_out_mesh(const std::filesystem::path& folder,
                                         const std::string& noun);

/// Writes airplane, duck, rabbit, sofa, teapot and truck by save_held_out_mesh(). Returns the files
/// by noun. Rabbit, sofa and teapot are held-out classes.
std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder);

}  // namespace item3d
