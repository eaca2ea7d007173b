// Computation of normals for meshes whose file has none.
#pragma once

#include "item3d/scene/model.h"

#include <cstdint>
#include <span>
#include <vector>

namespace item3d {

/// Returns normals of unit length: for each vertex, the area-weighted sum of face normals over all
/// vertices at its position, so that UV seams do not show. Where only degenerate triangles meet,
/// the normal is (0, 0, 1). indices: three for each triangle.
std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::uint32_t> indices);

/// Normals that several corners may share.
struct CornerNormals {
    std::vector<std::uint32_t> corners;  ///< indices into normals, three for each triangle
    std::vector<Vec3> normals;           ///< unit length
};

/// Returns smooth normals within each group: edges between groups are sharp. groups: one arbitrary
/// number for each triangle.
CornerNormals grouped_normals(std::span<const Vec3> positions,
                              std::span<const std::uint32_t> indices,
                              std::span<const std::int64_t> groups);

/// Applies the flat shading that glTF prescribes for missing normals, and drops the file's
/// tangents. Every corner becomes its own vertex, in the order of the file (so that vertex numbers
/// are the same in all nodes that have the mesh, mirrored or not). Returns the source vertex of
/// each new vertex.
std::vector<std::uint32_t> make_flat(Primitive& primitive);

}  // namespace item3d
