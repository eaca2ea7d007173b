// The statements of an OBJ file, before they are made a model. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Indices from 0 into the file's lists, -1: not given.
struct ObjCorner {
    std::int32_t position = -1;
    std::int32_t uv = -1;
    std::int32_t normal = -1;
    bool operator==(const ObjCorner&) const = default;
};

struct ObjFace {
    std::size_t first_corner;
    std::uint32_t corner_count;
    int material;  ///< into ObjFile::material_names
    int line;
    /// What "s" says: above 0 a group, 0 "off", unsaid_smoothing where there is no such statement.
    std::int64_t smoothing;
    int group;  ///< into ObjFile::groups; -1: in none
};

inline constexpr std::int64_t unsaid_smoothing = std::int64_t{1} << 40;

struct ObjFile {
    std::vector<glm::dvec3> positions;
    std::vector<Vec4> colors;  ///< linear; as long as positions, or empty
    std::vector<Vec2> uvs;
    std::vector<Vec3> normals;  ///< unit length, or zero where the file's is no direction
    std::vector<ObjCorner> corners;
    std::vector<ObjFace> faces;               ///< all corners of all faces are within the lists
    std::vector<std::string> material_names;  ///< as written; "" for faces before any usemtl
    std::vector<std::vector<std::string>> groups;  ///< names of the object and of the groups
    std::vector<std::string> libraries;            ///< what stands behind each mtllib
};

/// Warns, once for each kind, of what it leaves out: faces of one or two corners, values that are
/// not finite, normals and texture coordinates that are not there. `subject` names the file. Throws
/// InputError with the line of what cannot be used.
ObjFile parse_obj(std::string_view text, const std::string& subject);

}  // namespace item3d
