// Writing of models as Wavefront OBJ. Internal to io.
#pragma once

#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <filesystem>

namespace item3d {

/// Writes .obj in world space, with .mtl and image files beside it.
void write_obj(const std::filesystem::path& path, const Model& model, const ModelEdit& edit);

}  // namespace item3d
