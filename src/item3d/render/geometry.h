// A model's triangles as tensors for the renderer.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// All primitives of a model as one vertex set. A vertex whose triangles have different tangents
/// there is duplicated. float32 unless stated otherwise, all on one device.
struct Geometry {
    at::Tensor positions;                 ///< [V, 3] world space; may require gradients
    at::Tensor normals;                   ///< [V, 3] unit
    at::Tensor tangents;                  ///< [V, 4] unit tangent, handedness; zeros without UVs
    at::Tensor uvs;                       ///< [V, 2], zeros without UVs
    std::vector<at::Tensor> further_uvs;  ///< [V, 2] each, for Primitive::further_uvs
    at::Tensor colors;                    ///< [V, 4] linear RGBA, ones without colours
    at::Tensor triangles;                 ///< [T, 3] int32, indices of vertices
    at::Tensor triangle_material;         ///< [T] int32, index into Model::materials
    at::Tensor triangle_primitive;        ///< [T] int32, index into Model::primitives
    /// [T, 3] int32: for each corner, the triangle across the opposite edge and that triangle's
    /// corner opposite the same edge, as 3 * triangle + corner; -1 without a neighbour (see
    /// topology.h). `antialias` computes it at each call where it is undefined.
    at::Tensor neighbours;

    static Geometry from_model(const Model& model, at::Device device = at::kCPU);
};

}  // namespace item3d
