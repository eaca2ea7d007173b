// Held-out meshes of the embedded prior's test edits.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Returns airplane, duck, rabbit, sofa, teapot and truck. Rabbit, sofa and teapot are held-out
/// classes. Of airplane, duck and truck, only some variants are held out.
std::vector<std::string> held_out_nouns();

/// Writes the first held-out variant of a class of prior/data/shapes/shapes.h, without materials or
/// UVs, as `folder`/NOUN.glb, and returns the path.
std::filesystem::path save_held_out_mesh(const std::filesystem::path& folder,
                                         const std::string& noun);

/// Writes the meshes of held_out_nouns() with save_held_out_mesh(). Returns the files by noun.
std::map<std::string, std::filesystem::path> save_held_out_meshes(
    const std::filesystem::path& folder);

}  // namespace item3d
