// Mesh of fixed topology whose vertices are optimised.
#pragma once

#include "item3d/render/geometry.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns unit normals [V, 3] at vertices: the area-weighted sum of the adjacent face normals.
/// positions [V, 3], triangles [T, 3] int64. Differentiable. The normal is (0, 0, 1) at vertices
/// whose triangles are all degenerate.
at::Tensor vertex_normals(const at::Tensor& positions, const at::Tensor& triangles);

/// Returns Geometry::neighbours [T, 3] int32 of a mesh without seams, in linear time. triangles [T,
/// 3]: int64 vertex indices. vertices: number of vertices.
at::Tensor mesh_neighbours(const at::Tensor& triangles, std::int64_t vertices);

/// Returns the mean over vertices of the squared distance between a vertex's offset and the mean of
/// its neighbours' offsets (umbrella operator), in units of the mean edge length. The loss is large
/// where a mesh crumples and 0 where neighbours have equal offsets. offsets [V, 3]. edges [E, 2]
/// int64: each edge once.
at::Tensor crumpling_loss(const at::Tensor& offsets, const at::Tensor& edges, float mean_edge);

/// Movable mesh. Coincident vertices (UV seams) move as one.
class MovableMesh {
  public:
    /// `model` must have one primitive. If `moves` is true, vertices get offsets that require
    /// gradients, and normals are computed from the moved vertices. Otherwise the geometry is the
    /// model's.
    MovableMesh(const Model& model, bool moves);

    /// Returns the geometry with the current offsets.
    Geometry geometry() const;
    bool moves() const { return offsets_.defined(); }
    /// Returns the offsets [U, 3], one per distinct position; undefined if nothing moves.
    at::Tensor& offsets() { return offsets_; }
    float mean_edge() const { return mean_edge_; }
    at::Tensor crumpling() const { return crumpling_loss(offsets_, edges_, mean_edge_); }

    /// Returns the constructor's model with the current positions and normals.
    Model apply(const Model& model) const;

  private:
    Geometry base_;
    at::Tensor offsets_;
    at::Tensor places_;     ///< [U, 3] distinct positions
    at::Tensor place_of_;   ///< [V] int64: index into places_
    at::Tensor triangles_;  ///< [T, 3] int64: indices into places_
    at::Tensor edges_;      ///< [E, 2] int64: indices into places_
    float mean_edge_ = 0;
};

}  // namespace item3d
