// A model's triangles as tensors, ready for the renderer.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// All primitives of a model in one set of vertices: at least theirs, more where tangents differ
/// between the triangles around one. float32 unless said otherwise, on one device.
struct Geometry {
    at::Tensor positions;  ///< [V, 3] world space; may require gradients
    at::Tensor normals;    ///< [V, 3] unit
    at::Tensor tangents;   ///< [V, 4] unit tangent, handedness; zeros where there are no UVs
    at::Tensor uvs;        ///< [V, 2], zeros where there are none
    std::vector<at::Tensor> further_uvs;  ///< the same for each of Primitive::further_uvs
    at::Tensor colors;                    ///< [V, 4] linear RGBA, ones where there are none
    at::Tensor triangles;                 ///< [T, 3] int32, indices of vertices
    at::Tensor triangle_material;         ///< [T] int32, index into Model::materials
    at::Tensor triangle_primitive;        ///< [T] int32, index into Model::primitives
    /// [T, 3] int32: the neighbour across the edge that faces each corner, as 3 * triangle + the
    /// corner that faces the same edge from there; -1 where there is none (see topology.h).
    /// `antialias` computes it at each call where it is undefined.
    at::Tensor neighbours;

    static Geometry from_model(const Model& model, at::Device device = at::kCPU);
};

}  // namespace item3d
