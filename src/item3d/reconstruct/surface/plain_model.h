// Models that are made from a mesh, with one primitive, one material and a UV map.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>

namespace item3d {

/// Makes a model of triangles [T, 3] int64 over positions [V, 3], with smooth normals and no UVs.
Model plain_model(const at::Tensor& positions, const at::Tensor& triangles);

/// Loads all triangles of a model file as one primitive; UVs are kept if all primitives have them.
Model load_plain_model(const std::filesystem::path& path);

/// Returns the texture size, a power of two from 1024 to 4096, that gives about two and a half
/// texels per pixel of the photographs. pixel: size of a pixel in world units.
int texture_size_for(const Model& model, float pixel);

/// Returns the model with UVs that use each texel at most once: its own UVs if they do so,
/// otherwise new UVs by xatlas.
Model unwrapped(Model model, int texture_size);

/// Returns a field that has plain_model's material everywhere. It is the reference of baking
/// (field/bake.h), so that a baked texel is the optimised field's value.
NeuralTexture constant_field(const NeuralTextureOptions& options);

/// Sets plain_model's material for fields of these ranges: the middle of each range.
void set_constant_material(Model& model, const MaterialRanges& ranges);

}  // namespace item3d
