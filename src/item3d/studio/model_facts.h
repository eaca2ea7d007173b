// Reading a model for the page: a .glb that browsers show, and what is in it.
#pragma once

#include <filesystem>

namespace item3d {

/// Loads the model and writes into the folder
///     model.glb    the file itself where it is a .glb that needs no decoder, else a plain copy
///     model.json   "format", "triangles", "bounds" ([lowest, highest], in the file's coordinates),
///                  "has_uv", "materials" ([{"index", "name"}]), "nodes", "meshes", "groups"
/// Throws InputError for what load_model() cannot use, ResourceError for a full disk. Meant for a
/// process of its own: a file made to break the reader ends that alone.
void write_model_facts(const std::filesystem::path& model, const std::filesystem::path& folder);

}  // namespace item3d
