// Normals for meshes whose file has none.
#pragma once

#include "item3d/scene/model.h"

#include <cstdint>
#include <span>
#include <vector>

namespace item3d {

/// Area-weighted sum of face normals over equal positions (so that UV seams do not show), unit
/// length; (0, 0, 1) where nothing but degenerate triangles meets. `indices`: three a triangle.
std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::uint32_t> indices);

/// Normals that several corners may share.
struct CornerNormals {
    std::vector<std::uint32_t> corners;  ///< one for each of the indices: into normals
    std::vector<Vec3> normals;           ///< unit length
};

/// As smooth_normals, but over the triangles of one group alone: edges between groups are sharp.
/// `groups`: one a triangle, any numbers.
CornerNormals grouped_normals(std::span<const Vec3> positions,
                              std::span<const std::uint32_t> indices,
                              std::span<const std::int64_t> groups);

/// What glTF asks for: flat shading, and tangents of the file without effect. Every corner
/// becomes a vertex of its own, in the order of the file (so that all nodes with the mesh, mirrored
/// or not, number them alike). Returns, for each new vertex, the one that it was.
std::vector<std::uint32_t> make_flat(Primitive& primitive);

}  // namespace item3d
