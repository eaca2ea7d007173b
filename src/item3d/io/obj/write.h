// Writing of models as Wavefront OBJ. Internal to io.
#pragma once

#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <filesystem>

namespace item3d {

/// Writes .obj with .mtl and PNGs beside it, in world space.
void write_obj(const std::filesystem::path& path, const Model& model, const ModelEdit& edit);

}  // namespace item3d
