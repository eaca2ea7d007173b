#include "item3d/render/tangents.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <tuple>

namespace item3d {
namespace {

using DVec3 = glm::dvec3;

constexpr std::int32_t none = -1;
constexpr double minimum = std::numeric_limits<float>::min();

/// A triangle over merged vertices. Edge k goes from corner k to corner k + 1.
struct Face {
    std::array<std::uint32_t, 3> vertices{};
    DVec3 along_u{0.0}, along_v{0.0};  ///< unit; zero where the UVs are degenerate
    bool keeps_orientation = false;    ///< the UVs are not mirrored
    bool has_direction = false;
    bool is_degenerate = false;  ///< two corners coincide
    std::array<std::int32_t, 3> neighbours{none, none, none};
    std::array<std::int32_t, 3> groups{none, none, none};  ///< group of each corner
};

/// Group of corners at one vertex whose faces are connected there and have the same mirroring.
/// These corners share a frame.
struct Group {
    std::uint32_t vertex;
    bool keeps_orientation;
    std::vector<std::uint32_t> corners;  ///< 3 * face + corner
};

DVec3 unit_or_zero(const DVec3& v) {
    const double length = glm::length(v);
    return length > minimum ? v / length : DVec3(0.0);
}

DVec3 project(const DVec3& v, const DVec3& normal) {
    return unit_or_zero(v - normal * glm::dot(normal, v));
}

class TangentSpace {
  public:
    explicit TangentSpace(const Primitive& primitive) : primitive_(primitive) {}

    std::vector<Vec4> compute() {
        merge_vertices();
        make_faces();
        link_neighbours();
        std::vector<Group> groups;
        for (std::uint32_t corner = 0; corner < 3 * faces_.size(); ++corner) {
            const Face& face = faces_[corner / 3];
            if (!face.has_direction || face.groups[corner % 3] != none) continue;
            groups.push_back({face.vertices[corner % 3], face.keeps_orientation, {}});
            gather(corner, static_cast<std::int32_t>(groups.size()) - 1, groups.back());
        }
        return to_corners(groups);
    }

  private:
    DVec3 position(std::uint32_t vertex) const { return DVec3(primitive_.positions[vertex]); }

    // Merges vertices that are equal in all relevant attributes, because files repeat vertices
    // arbitrarily.
    void merge_vertices() {
        const std::size_t count = primitive_.positions.size();
        std::vector<std::array<std::uint32_t, 8>> keys(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 &p = primitive_.positions[i], &n = primitive_.normals[i];
            const Vec2& t = primitive_.uvs[i];
            std::array<float, 8> values{p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
            for (float& value : values)
                value += 0.0f;  // turns -0 into 0, whose bits differ
            std::memcpy(keys[i].data(), values.data(), sizeof values);
        }
        std::vector<std::uint32_t> order(count);
        std::iota(order.begin(), order.end(), 0u);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::tie(keys[a], a) < std::tie(keys[b], b);
        });
        merged_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const bool is_same = i > 0 && keys[order[i]] == keys[order[i - 1]];
            merged_[order[i]] = is_same ? merged_[order[i - 1]] : order[i];
        }
    }

    void make_faces() {
        faces_.resize(primitive_.indices.size() / 3);
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            Face& face = faces_[f];
            std::array<DVec3, 3> p;
            std::array<glm::dvec2, 3> t;
            for (std::size_t k = 0; k < 3; ++k) {
                face.vertices[k] = merged_[primitive_.indices[3 * f + k]];
                p[k] = position(face.vertices[k]);
                t[k] = glm::dvec2(primitive_.uvs[face.vertices[k]]);
            }
            face.is_degenerate = p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
            if (face.is_degenerate) continue;
            const DVec3 edge1 = p[1] - p[0], edge2 = p[2] - p[0];
            const glm::dvec2 uv1 = t[1] - t[0], uv2 = t[2] - t[0];
            const double area = uv1.x * uv2.y - uv1.y * uv2.x;
            if (!std::isfinite(area) || std::abs(area) <= minimum) continue;
            face.keeps_orientation = area > 0.0;
            const double sign = area > 0.0 ? 1.0 : -1.0;
            face.along_u = unit_or_zero(sign * (edge1 * uv2.y - edge2 * uv1.y));
            face.along_v = unit_or_zero(sign * (edge2 * uv1.x - edge1 * uv2.x));
            face.has_direction = face.along_u != DVec3(0.0) && face.along_v != DVec3(0.0);
        }
    }

    // Links neighbours, that is, two faces that traverse their common edge in opposite directions.
    // If an edge has more than two faces, they are joined in pairs, in the order of the file.
    void link_neighbours() {
        struct Edge {
            std::uint32_t low, high;
            std::uint32_t corner;  // first corner of the edge
            bool is_rising;
        };
        std::vector<Edge> edges;
        for (std::uint32_t corner = 0; corner < 3 * faces_.size(); ++corner) {
            const Face& face = faces_[corner / 3];
            if (face.is_degenerate) continue;
            const std::uint32_t a = face.vertices[corner % 3];
            const std::uint32_t b = face.vertices[(corner % 3 + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), corner, a < b});
        }
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
        });
        std::vector<std::uint32_t> rising, falling;
        for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
            rising.clear();
            falling.clear();
            for (; end < edges.size() && edges[end].low == edges[begin].low &&
                   edges[end].high == edges[begin].high;
                 ++end) {
                (edges[end].is_rising ? rising : falling).push_back(edges[end].corner);
            }
            for (std::size_t i = 0; i < std::min(rising.size(), falling.size()); ++i) {
                neighbour(rising[i]) = static_cast<std::int32_t>(falling[i] / 3);
                neighbour(falling[i]) = static_cast<std::int32_t>(rising[i] / 3);
            }
        }
    }

    std::int32_t& neighbour(std::uint32_t corner) {
        return faces_[corner / 3].neighbours[corner % 3];
    }

    // Gathers all faces around the vertex that are connected by edges without crossing a mirrored
    // seam. Faces with degenerate UVs join the first group that reaches them.
    void gather(std::uint32_t first, std::int32_t index, Group& group) {
        std::vector<std::int32_t> open{static_cast<std::int32_t>(first / 3)};
        while (!open.empty()) {
            const std::int32_t f = open.back();
            open.pop_back();
            if (f == none) continue;
            Face& face = faces_[static_cast<std::size_t>(f)];
            const std::size_t k = static_cast<std::size_t>(
                std::find(face.vertices.begin(), face.vertices.end(), group.vertex) -
                face.vertices.begin());
            if (k == 3 || face.groups[k] != none) continue;
            const bool is_free =
                !face.has_direction && face.groups == std::array<std::int32_t, 3>{none, none, none};
            if (is_free) face.keeps_orientation = group.keeps_orientation;
            if (face.keeps_orientation != group.keeps_orientation) continue;
            face.groups[k] = index;
            group.corners.push_back(static_cast<std::uint32_t>(3 * f) +
                                    static_cast<std::uint32_t>(k));
            open.push_back(face.neighbours[(k + 2) % 3]);
            open.push_back(face.neighbours[k]);
        }
    }

    // Returns the mean direction of growing u over the faces, each projected perpendicular to the
    // vertex normal and weighted by the face's angle at the vertex.
    DVec3 direction(const Group& group) const {
        const DVec3 normal(primitive_.normals[group.vertex]);
        DVec3 sum(0.0);
        for (const std::uint32_t corner : group.corners) {
            const Face& face = faces_[corner / 3];
            if (!face.has_direction) continue;
            const DVec3 at = position(group.vertex);
            const DVec3 to_last =
                project(position(face.vertices[(corner % 3 + 2) % 3]) - at, normal);
            const DVec3 to_next =
                project(position(face.vertices[(corner % 3 + 1) % 3]) - at, normal);
            const double angle = std::acos(std::clamp(glm::dot(to_last, to_next), -1.0, 1.0));
            sum += angle * project(face.along_u, normal);
        }
        return unit_or_zero(sum);
    }

    static DVec3 across(const DVec3& normal) {
        return unit_or_zero(
            glm::cross(normal, std::abs(normal.x) < 0.9 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
    }

    std::vector<Vec4> to_corners(const std::vector<Group>& groups) const {
        // Tangent of each merged vertex, for corners of degenerate triangles. Where a vertex has no
        // tangent either, MikkTSpace sets (1, 0, 0). This code sets a vector perpendicular to the
        // normal, which is as arbitrary, but gives a valid frame.
        std::vector<Vec4> spare(primitive_.positions.size(), Vec4(0.0f));
        std::vector<Vec4> of_group;
        for (const Group& group : groups) {
            DVec3 tangent = direction(group);
            if (tangent == DVec3(0.0)) tangent = across(DVec3(primitive_.normals[group.vertex]));
            of_group.emplace_back(Vec3(tangent), group.keeps_orientation ? -1.0f : 1.0f);
            if (spare[group.vertex].w == 0.0f) spare[group.vertex] = of_group.back();
        }
        std::vector<Vec4> tangents(3 * faces_.size());
        for (std::size_t corner = 0; corner < tangents.size(); ++corner) {
            const Face& face = faces_[corner / 3];
            const std::uint32_t vertex = face.vertices[corner % 3];
            const std::int32_t group = face.groups[corner % 3];
            if (group != none) {
                tangents[corner] = of_group[static_cast<std::size_t>(group)];
            } else if (face.is_degenerate && spare[vertex].w != 0.0f) {
                tangents[corner] = spare[vertex];
            } else {
                tangents[corner] = Vec4(Vec3(across(DVec3(primitive_.normals[vertex]))), 1.0f);
            }
        }
        return tangents;
    }

    const Primitive& primitive_;
    std::vector<std::uint32_t> merged_;  ///< index of the first equal vertex, for each vertex
    std::vector<Face> faces_;
};

}  // namespace

std::vector<Vec4> corner_tangents(const Primitive& primitive) {
    return TangentSpace(primitive).compute();
}

void add_tangents(Primitive& primitive) {
    const std::vector<Vec4> corners = corner_tangents(primitive);
    const std::size_t count = primitive.positions.size();
    primitive.tangents.assign(count, Vec4(0.0f));
    // For each vertex, the next copy that was split off the same vertex.
    std::vector<std::int32_t> next(count, none);
    for (std::size_t corner = 0; corner < corners.size(); ++corner) {
        const std::uint32_t source = primitive.indices[corner];
        std::uint32_t vertex = source;
        while (primitive.tangents[vertex].w != 0.0f &&
               primitive.tangents[vertex] != corners[corner] && next[vertex] != none) {
            vertex = static_cast<std::uint32_t>(next[vertex]);
        }
        if (primitive.tangents[vertex].w == 0.0f) {
            primitive.tangents[vertex] = corners[corner];
        } else if (primitive.tangents[vertex] != corners[corner]) {
            const auto copy = static_cast<std::uint32_t>(primitive.positions.size());
            next[vertex] = static_cast<std::int32_t>(copy);
            next.push_back(none);
            const auto repeat = [&](auto& values) {
                if (values.size() != copy) return;  // the primitive lacks this attribute
                const auto value = values[source];
                values.push_back(value);
            };
            repeat(primitive.positions);
            repeat(primitive.normals);
            repeat(primitive.uvs);
            for (std::vector<Vec2>& uvs : primitive.further_uvs)
                repeat(uvs);
            repeat(primitive.colors);
            primitive.tangents.push_back(corners[corner]);
            vertex = copy;
        }
        primitive.indices[corner] = vertex;
    }
}

}  // namespace item3d
