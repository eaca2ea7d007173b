// Source models of the edit suite: meshes in plain colours and with stripes.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/model.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// Parses meshes that are given as NOUN=FILE. Returns the files by noun. Throws UsageError for
/// other forms.
std::map<std::string, std::filesystem::path> named_meshes(const std::vector<std::string>& named);
/// Returns the meshes of named_meshes() and the demo mug.
std::map<std::string, std::filesystem::path> suite_meshes(const std::vector<std::string>& named);

/// Returns the mesh with one material without textures, with this linear base colour, roughness 0.5
/// and metallic 0.
Model plain_model(const Model& mesh, Vec3 base_color);

/// Returns the mesh with stripes of two linear base colours. They are painted into a texture with
/// the mesh's own UV map. The colours change along an axis (0 is x, 1 is y) in `count` pairs over
/// the mesh's size. The mesh must have UVs.
Model striped_model(const Model& mesh, Vec3 first, Vec3 second, int axis, int count);

}  // namespace item3d
