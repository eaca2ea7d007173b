// Preparation of a model for the page: a .glb for browsers, and a summary of its contents.
#pragma once

#include <filesystem>

namespace item3d {

/// Loads the model and writes into the folder
///    model.glb    the file itself if it is a .glb that needs no decoder, else a plain copy
///    model.json   "format", "triangles", "bounds" ([lowest, highest], in the file's coordinates),
///                 "has_uv", "materials" ([{"index", "name"}]), "nodes", "meshes", "groups",
///                 "warnings" (the lines that load_model() printed)
/// Throws InputError if load_model() cannot use the file, and ResourceError for a full disk. The
/// function must run in a separate process, because a malicious file may crash it.
void write_model_summary(const std::filesystem::path& model, const std::filesystem::path& folder);

}  // namespace item3d
