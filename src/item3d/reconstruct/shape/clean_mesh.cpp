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

/// Returns the mesh without unused vertices.
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

/// Connected parts of a mesh. The index of one of its vertices identifies a part.
class Parts {
  public:
    explicit Parts(const TriangleMesh& mesh)
        : positions_(mesh.positions.detach().contiguous()), indices_(indices_of(mesh)) {
        parent_.resize(static_cast<std::size_t>(positions_.size(0)));
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
        for (std::size_t i = 0; i < indices_.size(); i += 3) {
            parent_[root_of(indices_[i])] = root_of(indices_[i + 1]);
            parent_[root_of(indices_[i + 1])] = root_of(indices_[i + 2]);
        }
        for (std::size_t vertex = 0; vertex < parent_.size(); ++vertex)
            parent_[vertex] = root_of(vertex);
        area_.resize(parent_.size());
        const float* p = positions_.const_data_ptr<float>();
        for (std::size_t i = 0; i < indices_.size(); i += 3) {
            const Vec3 a = point(p, indices_[i]);
            area_[parent_[indices_[i]]] += glm::length(
                glm::cross(point(p, indices_[i + 1]) - a, point(p, indices_[i + 2]) - a));
        }
    }

    double area(std::size_t part) const { return area_[part]; }
    double area_of_largest() const {
        return area_.empty() ? 0 : *std::max_element(area_.begin(), area_.end());
    }

    /// Returns the mean of a vertex value over each part; 0 at indices that identify no part.
    std::vector<double> means_of(const double* values) const {
        std::vector<double> sum(parent_.size()), count(parent_.size());
        for (std::size_t vertex = 0; vertex < parent_.size(); ++vertex) {
            sum[parent_[vertex]] += values[vertex];
            count[parent_[vertex]] += 1;
        }
        for (std::size_t part = 0; part < sum.size(); ++part)
            sum[part] /= std::max(1.0, count[part]);
        return sum;
    }

    template <class IsKept>
    TriangleMesh those(IsKept&& is_kept) const {
        std::vector<unsigned int> kept;
        for (std::size_t i = 0; i < indices_.size(); i += 3)
            if (is_kept(parent_[indices_[i]]))
                kept.insert(kept.end(), indices_.begin() + static_cast<std::ptrdiff_t>(i),
                            indices_.begin() + static_cast<std::ptrdiff_t>(i + 3));
        return compacted(positions_, kept);
    }

  private:
    std::size_t root_of(std::size_t vertex) {
        while (parent_[vertex] != vertex)
            vertex = parent_[vertex] = parent_[parent_[vertex]];
        return vertex;
    }

    at::Tensor positions_;
    std::vector<unsigned int> indices_;
    std::vector<std::size_t> parent_;
    std::vector<double> area_;  ///< twice the area, by part
};

}  // namespace

TriangleMesh without_specks(const TriangleMesh& mesh, double share) {
    const Parts parts(mesh);
    const double minimum = share * parts.area_of_largest();
    return parts.those([&](std::size_t part) { return parts.area(part) >= minimum; });
}

TriangleMesh without_ghosts(const TriangleMesh& mesh, const at::Tensor& shown, double fewest) {
    const Parts parts(mesh);
    const at::Tensor counts = shown.to(at::kDouble).contiguous();
    const std::vector<double> means = parts.means_of(counts.const_data_ptr<double>());
    return parts.those([&](std::size_t part) {
        return means[part] >= fewest || parts.area(part) == parts.area_of_largest();
    });
}

TriangleMesh simplified(const TriangleMesh& mesh, std::int64_t triangles) {
    const at::Tensor positions = mesh.positions.detach().contiguous();
    auto indices = indices_of(mesh);
    std::vector<unsigned int> fewer(indices.size());
    constexpr float largest_error = 1.0f;  // no limit: the number of triangles decides
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
