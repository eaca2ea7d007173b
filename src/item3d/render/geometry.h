// A model's triangles as tensors, ready for the renderer.
#pragma once

#include "item3d/scene/model.h"

#include <torch/types.h>

namespace item3d {

/// All primitives of a model in one set of vertices: at least theirs, more where tangents differ
/// between the triangles around one. float32 unless said otherwise, on one device.
struct Geometry {
    torch::Tensor positions;  ///< [V, 3] world space; may require gradients
    torch::Tensor normals;    ///< [V, 3] unit
    torch::Tensor tangents;   ///< [V, 4] unit tangent, handedness; zeros where there are no UVs
    torch::Tensor uvs;        ///< [V, 2], zeros where there are none
    torch::Tensor colors;     ///< [V, 4] linear RGBA, ones where there are none
    torch::Tensor triangles;  ///< [T, 3] int32, indices of vertices
    torch::Tensor triangle_material;   ///< [T] int32, index into Model::materials
    torch::Tensor triangle_primitive;  ///< [T] int32, index into Model::primitives
    /// [T, 3] int32: the neighbour across the edge that faces each corner, as 3 * triangle + the
    /// corner that faces the same edge from there; -1 where there is none (see topology.h).
    /// `antialias` computes it at each call where it is undefined.
    torch::Tensor neighbours;

    static Geometry from_model(const Model& model, torch::Device device = torch::kCPU);
};

}  // namespace item3d
