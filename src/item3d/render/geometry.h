// A model's triangles as tensors for the renderer.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// All primitives of a model as one vertex set. If the triangles at a vertex have different
/// tangents there, the vertex is duplicated. Tensors are float32 unless stated otherwise, and all
/// on one device.
struct Geometry {
    at::Tensor positions;                 ///< [V, 3] world space; may require gradients
    at::Tensor normals;                   ///< [V, 3] unit
    at::Tensor tangents;                  ///< [V, 4] unit tangent and handedness; zeros without UVs
    at::Tensor uvs;                       ///< [V, 2], zeros without UVs
    std::vector<at::Tensor> further_uvs;  ///< [V, 2] each, for Primitive::further_uvs
    at::Tensor colors;                    ///< [V, 4] linear RGBA, ones without colours
    at::Tensor triangles;                 ///< [T, 3] int32, indices of vertices
    at::Tensor triangle_material;         ///< [T] int32, index into Model::materials
    at::Tensor triangle_primitive;        ///< [T] int32, index into Model::primitives
    /// [T, 3] int32: for each corner, the neighbour across the opposite edge as 3 * triangle +
    /// corner, where `corner` is the neighbour's corner opposite the same edge; -1 without a
    /// neighbour (see topology.h). If the tensor is undefined, `antialias` computes it at each
    /// call.
    at::Tensor neighbours;

    static Geometry from_model(const Model& model, at::Device device = at::kCPU);
};

}  // namespace item3d
