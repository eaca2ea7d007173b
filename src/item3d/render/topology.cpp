#include "item3d/render/topology.h"

#include "item3d/render/checks.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>
#include <vector>

namespace item3d {
namespace {

/// The smallest vertex index at each vertex's position.
std::vector<std::int32_t> merge_by_position(const float* positions, std::int64_t vertices) {
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

struct Edge {
    std::int32_t low, high;
    std::int64_t corner;  ///< 3 * triangle + the corner that faces the edge
    bool same(const Edge& other) const { return low == other.low && high == other.high; }
};

}  // namespace

at::Tensor triangle_neighbours(const at::Tensor& positions_, const at::Tensor& triangles_) {
    const at::Tensor positions =
        checked("triangle_neighbours", "positions", positions_.detach(), at::kFloat, {-1, 3});
    const at::Tensor triangles =
        checked("triangle_neighbours", "triangles", triangles_, at::kInt, {-1, 3});
    // Adding zero turns -0 into 0, whose bits differ.
    const at::Tensor unsigned_zeros = positions + 0.0f;
    const std::vector<std::int32_t> merged =
        merge_by_position(unsigned_zeros.const_data_ptr<float>(), positions.size(0));
    const std::int32_t* corners = triangles.const_data_ptr<std::int32_t>();

    std::vector<Edge> edges;
    edges.reserve(static_cast<std::size_t>(3 * triangles.size(0)));
    for (std::int64_t t = 0; t < triangles.size(0); ++t) {
        for (int k = 0; k < 3; ++k) {
            const auto a = merged[static_cast<std::size_t>(corners[3 * t + (k + 1) % 3])];
            const auto b = merged[static_cast<std::size_t>(corners[3 * t + (k + 2) % 3])];
            edges.push_back({std::min(a, b), std::max(a, b), 3 * t + k});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
    });

    at::Tensor neighbours = at::full_like(triangles, -1);
    std::int32_t* out = neighbours.data_ptr<std::int32_t>();
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
    return neighbours;
}

}  // namespace item3d
