#include "item3d/reconstruct/shape/clean_mesh.h"

#include "item3d/core/math.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace item3d {

namespace {

std::vector<unsigned int> indices_of(const TriangleMesh& mesh) {
    const at::Tensor triangles = mesh.triangles.contiguous();
    const std::int64_t* from = triangles.const_data_ptr<std::int64_t>();
    std::vector<unsigned int> indices(static_cast<std::size_t>(triangles.numel()));
    std::transform(from, from + triangles.numel(), indices.begin(),
                   [](std::int64_t index) { return static_cast<unsigned int>(index); });
    return indices;
}

/// Vertices that are not used are left out.
TriangleMesh compacted(const at::Tensor& positions, const std::vector<unsigned int>& indices) {
    std::vector<std::int64_t> new_index(static_cast<std::size_t>(positions.size(0)), -1);
    std::vector<std::int64_t> kept, triangles;
    for (const unsigned int index : indices) {
        std::int64_t& place = new_index[index];
        if (place < 0) {
            place = static_cast<std::int64_t>(kept.size());
            kept.push_back(index);
        }
        triangles.push_back(place);
    }
    return {positions.index_select(0, at::tensor(kept, at::kLong)),
            at::tensor(triangles, at::kLong).reshape({-1, 3})};
}

Vec3 point(const float* positions, unsigned int index) {
    return {positions[3 * index], positions[3 * index + 1], positions[3 * index + 2]};
}

/// The root of a vertex in a forest of parents, with shortened paths.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t vertex) {
    while (parent[vertex] != vertex)
        vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
}

}  // namespace

TriangleMesh without_specks(const TriangleMesh& mesh, double share) {
    const at::Tensor positions = mesh.positions.detach().contiguous();
    const float* p = positions.const_data_ptr<float>();
    const auto indices = indices_of(mesh);
    std::vector<std::size_t> parent(static_cast<std::size_t>(positions.size(0)));
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        parent[root_of(parent, indices[i])] = root_of(parent, indices[i + 1]);
        parent[root_of(parent, indices[i + 1])] = root_of(parent, indices[i + 2]);
    }
    std::vector<double> area(parent.size(), 0.0);
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const Vec3 a = point(p, indices[i]);
        area[root_of(parent, indices[i])] +=
            glm::length(glm::cross(point(p, indices[i + 1]) - a, point(p, indices[i + 2]) - a));
    }
    const double least = share * *std::max_element(area.begin(), area.end());
    std::vector<unsigned int> kept;
    for (std::size_t i = 0; i < indices.size(); i += 3)
        if (area[root_of(parent, indices[i])] >= least)
            kept.insert(kept.end(), indices.begin() + static_cast<std::ptrdiff_t>(i),
                        indices.begin() + static_cast<std::ptrdiff_t>(i + 3));
    return compacted(positions, kept);
}

TriangleMesh simplified(const TriangleMesh& mesh, std::int64_t triangles) {
    const at::Tensor positions = mesh.positions.detach().contiguous();
    auto indices = indices_of(mesh);
    std::vector<unsigned int> fewer(indices.size());
    constexpr float largest_error = 1.0f;  // the number of triangles decides
    const std::size_t count = meshopt_simplify(
        fewer.data(), indices.data(), indices.size(), positions.const_data_ptr<float>(),
        static_cast<std::size_t>(positions.size(0)), 3 * sizeof(float),
        std::min(indices.size(), static_cast<std::size_t>(3 * triangles)), largest_error, 0,
        nullptr);
    fewer.resize(count);
    return compacted(positions, fewer);
}

double enclosed_volume(const TriangleMesh& mesh) {
    const at::Tensor p = mesh.positions.detach().to(at::kDouble);
    const auto corner = [&](int c) { return p.index_select(0, mesh.triangles.select(1, c)); };
    return (corner(0) * at::linalg_cross(corner(1), corner(2))).sum().item<double>() / 6;
}

}  // namespace item3d
