// The model formats. Internal to scene/io.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/save.h"
#include "item3d/scene/model.h"

#include <filesystem>

namespace item3d {

/// Wavefront OBJ with its MTL files, one primitive a material. Throws InputError.
Model read_obj(const std::filesystem::path& path, const Bytes& bytes);
/// glTF 2.0, binary or JSON. Throws InputError.
Model read_gltf(const std::filesystem::path& path, const Bytes& bytes);

/// .obj with .mtl and PNGs beside it, in world space.
void write_obj(const std::filesystem::path& path, const Model& model, const ModelEdit& edit);
/// .glb or .gltf: the model's own document patched, or a new one.
void write_gltf(const std::filesystem::path& path, const Model& model, const ModelEdit& edit);

}  // namespace item3d
