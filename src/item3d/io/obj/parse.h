// Parsing of an OBJ file's statements. Internal to io.
#pragma once

#include "item3d/core/math.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Indices into the file's lists, from 0; -1 if unset.
struct ObjCorner {
    std::int32_t position = -1;
    std::int32_t uv = -1;
    std::int32_t normal = -1;
    bool operator==(const ObjCorner&) const = default;
};

struct ObjFace {
    std::size_t first_corner;
    std::uint32_t corner_count;
    int material;  ///< index into ObjFile::material_names
    int line;
    /// Value of the last "s" statement: a smoothing group above 0, or 0 for "off"; unsaid_smoothing
    /// if there was no statement.
    std::int64_t smoothing;
    int group;  ///< index into ObjFile::groups; -1 if none
};

inline constexpr std::int64_t unsaid_smoothing = std::int64_t{1} << 40;

struct ObjFile {
    std::vector<glm::dvec3> positions;
    std::vector<Vec4> colors;  ///< linear; as long as positions, or empty
    std::vector<Vec2> uvs;
    std::vector<Vec3> normals;  ///< unit length; zero for an invalid one
    std::vector<ObjCorner> corners;
    std::vector<ObjFace> faces;               ///< all corner indices are valid
    std::vector<std::string> material_names;  ///< as written; "" for faces before any usemtl
    /// Each entry: the names of the groups and of the object to which a face belongs.
    std::vector<std::vector<std::string>> groups;
    std::vector<std::string> libraries;  ///< text after each mtllib
};

/// Parses a file. Warns, once for each kind, of what it skips: faces of one or two corners,
/// non-finite values, missing normals and texture coordinates. subject: name of the file. Throws
/// InputError with the line of an error.
ObjFile parse_obj(std::string_view text, const std::string& subject);

}  // namespace item3d
