// Triangle adjacency on plain arrays.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <tuple>
#include <vector>

namespace item3d {

/// Returns, for each vertex, the smallest index of the vertices at its position. positions: [V, 3]
/// without -0.
inline std::vector<std::int32_t> merge_by_position(const float* positions, std::int64_t vertices) {
    std::vector<std::int32_t> order(static_cast<std::size_t>(vertices));
    std::iota(order.begin(), order.end(), 0);
    const auto compare = [&](std::int32_t a, std::int32_t b) {
        return std::memcmp(positions + 3 * static_cast<std::int64_t>(a),
                           positions + 3 * static_cast<std::int64_t>(b), 3 * sizeof(float));
    };
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        const int difference = compare(a, b);
        return difference != 0 ? difference < 0 : a < b;
    });
    std::vector<std::int32_t> merged(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && compare(order[i - 1], order[i]) == 0;
        merged[static_cast<std::size_t>(order[i])] =
            same ? merged[static_cast<std::size_t>(order[i - 1])] : order[i];
    }
    return merged;
}

/// An edge of a triangle, by its end vertices.
struct TriangleEdge {
    std::int32_t low, high;
    std::int64_t corner;  ///< 3 * triangle + the corner opposite the edge
    bool same(const TriangleEdge& other) const { return low == other.low && high == other.high; }
};

/// Fills `out` [T, 3] as Geometry::neighbours describes. corners: [T, 3] vertices. merged:
/// representative of each vertex; if null, each vertex represents itself.
inline void find_neighbours(const std::int32_t* corners, std::int64_t triangles,
                            const std::int32_t* merged, std::int32_t* out) {
    std::vector<TriangleEdge> edges;
    edges.reserve(static_cast<std::size_t>(3 * triangles));
    for (std::int64_t t = 0; t < triangles; ++t) {
        for (int k = 0; k < 3; ++k) {
            std::int32_t a = corners[3 * t + (k + 1) % 3], b = corners[3 * t + (k + 2) % 3];
            if (merged != nullptr) {
                a = merged[a];
                b = merged[b];
            }
            edges.push_back({std::min(a, b), std::max(a, b), 3 * t + k});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const TriangleEdge& a, const TriangleEdge& b) {
        return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
    });

    std::fill(out, out + 3 * triangles, -1);
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].same(edges[i]))
            ++end;
        if (end - i == 2) {
            out[edges[i].corner] = static_cast<std::int32_t>(edges[i + 1].corner);
            out[edges[i + 1].corner] = static_cast<std::int32_t>(edges[i].corner);
        }
        i = end;
    }
}

}  // namespace item3d
