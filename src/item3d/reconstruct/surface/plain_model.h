// A mesh on its way to becoming a textured model: one primitive, one material, a UV map.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>

namespace item3d {

/// Triangles [T, 3] int64 over positions [V, 3], with smooth normals and no UVs.
Model plain_model(const at::Tensor& positions, const at::Tensor& triangles);

/// All triangles of a model file as one primitive: UVs stay where all of it has them.
Model load_plain_model(const std::filesystem::path& path);

/// Texels of a side, a power of two from 1024 to 4096, of which about two and a half lie across a
/// pixel of the photographs. pixel: world units.
int texture_size_for(const Model& model, float pixel);

/// With UVs that each texel is used once in: the model's own, or new ones by xatlas.
Model unwrapped(Model model, int texture_size);

/// The field whose materials are those of plain_model's material everywhere: what baking compares
/// with (field/bake.h), so that a baked texel is the optimised field's value.
NeuralTexture constant_field(const NeuralTextureOptions& options);

/// plain_model's material for fields of these ranges: the middle of each.
void set_constant_material(Model& model, const MaterialRanges& ranges);

}  // namespace item3d
