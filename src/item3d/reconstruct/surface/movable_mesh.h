// Mesh of fixed topology whose vertices are optimised.
#pragma once

#include "item3d/render/geometry.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns unit normals [V, 3] at vertices: the area-weighted sum of the adjacent face normals.
/// positions [V, 3], triangles [T, 3] int64. Differentiable; (0, 0, 1) at vertices of degenerate
/// triangles only.
at::Tensor vertex_normals(const at::Tensor& positions, const at::Tensor& triangles);

/// Returns Geometry::neighbours [T, 3] int32 of a mesh without seams, in linear time. triangles [T,
/// 3] int64 below `vertices`.
at::Tensor mesh_neighbours(const at::Tensor& triangles, std::int64_t vertices);

/// Returns the mean over vertices of the squared distance, in units of the mean edge, of `offsets`
/// [V, 3] from the mean of the neighbours' offsets (umbrella operator): large where a mesh
/// crumples, 0 where parts move rigidly. edges [E, 2] int64, each once.
at::Tensor crumpling_loss(const at::Tensor& offsets, const at::Tensor& edges, float mean_edge);

/// Movable mesh. Coincident vertices (UV seams) move as one.
class MovableMesh {
  public:
    /// model: one primitive. moves: vertices get an offset that requires gradients, and normals
    /// follow; otherwise everything stays as in the model.
    MovableMesh(const Model& model, bool moves);

    /// Returns the geometry with the current offsets.
    Geometry geometry() const;
    bool moves() const { return offsets_.defined(); }
    /// Offsets [U, 3], one per distinct position; undefined if nothing moves.
    at::Tensor& offsets() { return offsets_; }
    float mean_edge() const { return mean_edge_; }
    at::Tensor crumpling() const { return crumpling_loss(offsets_, edges_, mean_edge_); }

    /// Returns the constructor's model with the current positions and normals.
    Model apply(const Model& model) const;

  private:
    Geometry base_;
    at::Tensor offsets_;
    at::Tensor places_;     ///< [U, 3]
    at::Tensor place_of_;   ///< [V] int64
    at::Tensor triangles_;  ///< [T, 3] int64 of places
    at::Tensor edges_;      ///< [E, 2] int64 of places
    float mean_edge_ = 0;
};

}  // namespace item3d
