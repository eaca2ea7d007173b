#include "item3d/reconstruct/surface/movable_mesh.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace item3d {

namespace {

/// Sums rows of `values` [R, C] into [size, C] at `index` [R]. Differentiable.
at::Tensor sum_at(const at::Tensor& values, const at::Tensor& index, std::int64_t size) {
    return at::zeros({size, values.size(1)}, values.options()).index_add(0, index, values);
}

}  // namespace

at::Tensor vertex_normals(const at::Tensor& positions, const at::Tensor& triangles) {
    const auto corner = [&](int c) { return positions.index_select(0, triangles.select(1, c)); };
    const at::Tensor a = corner(0);
    const at::Tensor faces = at::linalg_cross(corner(1) - a, corner(2) - a);
    at::Tensor sums = at::zeros_like(positions);
    for (int c = 0; c < 3; ++c)
        sums = sums.index_add(0, triangles.select(1, c), faces);
    const at::Tensor length = sums.norm(2, 1, true);
    const at::Tensor up = at::tensor({0.0f, 0.0f, 1.0f}).expand_as(sums);
    return at::where(length > 1e-20f, sums / length.clamp_min(1e-20f), up);
}

at::Tensor mesh_neighbours(const at::Tensor& triangles_, std::int64_t vertices) {
    const at::Tensor triangles = triangles_.contiguous();
    const std::int64_t* t = triangles.const_data_ptr<std::int64_t>();
    const std::int64_t corners = triangles.numel();
    const auto ends = [&](std::int64_t corner) {
        const std::int64_t first = corner - corner % 3;
        return std::minmax(t[first + (corner + 1) % 3], t[first + (corner + 2) % 3]);
    };
    // Triangle corners, grouped by the lower vertex of the opposite edge. Each group has only a few
    // corners.
    std::vector<std::int64_t> begin(static_cast<std::size_t>(vertices) + 2, 0);
    for (std::int64_t c = 0; c < corners; ++c)
        ++begin[static_cast<std::size_t>(ends(c).first) + 2];
    for (std::size_t v = 2; v < begin.size(); ++v)
        begin[v] += begin[v - 1];
    std::vector<std::int64_t> by_vertex(static_cast<std::size_t>(corners));
    for (std::int64_t c = 0; c < corners; ++c)
        by_vertex[static_cast<std::size_t>(begin[static_cast<std::size_t>(ends(c).first) + 1]++)] =
            c;

    at::Tensor neighbours = at::full({triangles.size(0), 3}, -1, at::kInt);
    std::int32_t* out = neighbours.data_ptr<std::int32_t>();
    for (std::size_t v = 0; v < static_cast<std::size_t>(vertices); ++v) {
        for (std::int64_t i = begin[v]; i < begin[v + 1]; ++i) {
            const std::int64_t corner = by_vertex[static_cast<std::size_t>(i)];
            std::int64_t other = -1;
            int found = 0;
            for (std::int64_t j = begin[v]; j < begin[v + 1]; ++j) {
                const std::int64_t candidate = by_vertex[static_cast<std::size_t>(j)];
                if (j == i || ends(candidate).second != ends(corner).second) continue;
                other = candidate;
                ++found;
            }
            if (found == 1) out[corner] = static_cast<std::int32_t>(other);
        }
    }
    return neighbours;
}

at::Tensor crumpling_loss(const at::Tensor& offsets, const at::Tensor& edges, float mean_edge) {
    const at::Tensor first = edges.select(1, 0), second = edges.select(1, 1);
    const std::int64_t count = offsets.size(0);
    const at::Tensor sums = sum_at(offsets.index_select(0, second), first, count) +
                            sum_at(offsets.index_select(0, first), second, count);
    const at::Tensor ones = at::ones({edges.size(0), 1});
    const at::Tensor degree =
        (sum_at(ones, first, count) + sum_at(ones, second, count)).clamp_min(1.0f);
    return ((offsets - sums / degree) / mean_edge).square().sum(1).mean();
}

MovableMesh::MovableMesh(const Model& model, bool moves) : base_(Geometry::from_model(model)) {
    ITEM3D_CHECK(model.primitives.size() == 1, "one primitive");
    const float* p = base_.positions.const_data_ptr<float>();
    const std::int64_t vertices = base_.positions.size(0);
    std::map<std::array<float, 3>, std::int64_t> found;
    std::vector<std::int64_t> place_of;
    std::vector<float> places;
    for (std::int64_t v = 0; v < vertices; ++v, p += 3) {
        const auto [entry, is_new] =
            found.try_emplace({p[0], p[1], p[2]}, static_cast<std::int64_t>(found.size()));
        if (is_new) places.insert(places.end(), p, p + 3);
        place_of.push_back(entry->second);
    }
    place_of_ = at::tensor(place_of, at::kLong);
    places_ = at::tensor(places).reshape({-1, 3});
    triangles_ =
        place_of_.index_select(0, base_.triangles.reshape({-1}).to(at::kLong)).reshape({-1, 3});
    std::set<std::pair<std::int64_t, std::int64_t>> edges;
    const std::int64_t* t = triangles_.const_data_ptr<std::int64_t>();
    for (std::int64_t i = 0; i < triangles_.size(0); ++i, t += 3)
        for (int c = 0; c < 3; ++c)
            if (t[c] != t[(c + 1) % 3]) edges.insert(std::minmax(t[c], t[(c + 1) % 3]));
    std::vector<std::int64_t> flat;
    for (const auto& [a, b] : edges) {
        flat.push_back(a);
        flat.push_back(b);
    }
    edges_ = at::tensor(flat, at::kLong).reshape({-1, 2});
    mean_edge_ = (places_.index_select(0, edges_.select(1, 0)) -
                  places_.index_select(0, edges_.select(1, 1)))
                     .norm(2, 1)
                     .mean()
                     .item<float>();
    if (moves) offsets_ = at::zeros_like(places_).set_requires_grad(true);
}

Geometry MovableMesh::geometry() const {
    Geometry geometry = base_;
    if (!moves()) return geometry;
    const at::Tensor moved = places_ + offsets_;
    geometry.positions = moved.index_select(0, place_of_);
    geometry.normals = vertex_normals(moved, triangles_).index_select(0, place_of_);
    return geometry;
}

Model MovableMesh::apply(const Model& model) const {
    const at::NoGradGuard no_gradient;
    Model result = model;
    if (!moves()) return result;
    const Geometry now = geometry();
    const float* positions = now.positions.const_data_ptr<float>();
    const float* normals = now.normals.const_data_ptr<float>();
    // Vertices that were split for tangents are at the end of the list.
    Primitive& primitive = result.primitives.front();
    for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        primitive.positions[v] = Vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
        primitive.normals[v] = Vec3(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
    }
    primitive.tangents.clear();
    return result;
}

}  // namespace item3d
