#include "item3d/region/surface_patches.h"

#include "item3d/region/color_selector.h"
#include "item3d/render/topology.h"

#include <cmath>
#include <numeric>

namespace item3d {
namespace {

constexpr float crease = 0.77f;   ///< cosine of an angle of 40 degrees between normals
constexpr float color_edge = 12;  ///< CIELAB distance between neighbours' mean colours
/// Barycentric coordinates (weights of vertices 0 and 1) of the points of a triangle where colours
/// are read.
constexpr float inner[3][2] = {{0.6f, 0.2f}, {0.2f, 0.6f}, {0.2f, 0.2f}};

class UnionFind {
  public:
    explicit UnionFind(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int find(int i) {
        while (parent_[static_cast<std::size_t>(i)] != i)
            i = parent_[static_cast<std::size_t>(i)] =
                parent_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(i)])];
        return i;
    }
    void join(int a, int b) { parent_[static_cast<std::size_t>(find(a))] = find(b); }

  private:
    std::vector<int> parent_;
};

/// Returns the CIELAB colour of each triangle, [T, 3], averaged over several points.
at::Tensor triangle_colors(const RegionScene& scene) {
    const std::int64_t count = scene.geometry.triangles.size(0);
    const at::Tensor triangle = at::arange(count, at::kLong).to(scene.geometry.positions.device());
    at::Tensor sum = at::zeros({count, 3});
    for (const auto& place : inner) {
        const at::Tensor weights =
            at::tensor({place[0], place[1]}).expand({count, 2}).contiguous().to(triangle.device());
        const Surface surface = surface_at(scene.geometry, triangle, weights);
        sum += lab_of(scene.textured.sample(surface).base_color.cpu());
    }
    return (sum / 3).contiguous();
}

}  // namespace

SurfacePatches find_patches(const RegionScene& scene) {
    const at::Tensor positions = scene.geometry.positions.detach().cpu().contiguous();
    const at::Tensor triangles = scene.geometry.triangles.cpu().contiguous();
    const at::Tensor neighbours = triangle_neighbours(positions, triangles).contiguous();
    const at::Tensor materials = scene.geometry.triangle_material.cpu().contiguous();
    const at::Tensor colors = triangle_colors(scene);
    const std::int64_t count = triangles.size(0);
    const float* p = positions.const_data_ptr<float>();
    const std::int32_t* t = triangles.const_data_ptr<std::int32_t>();
    const std::int32_t* beside = neighbours.const_data_ptr<std::int32_t>();
    const std::int32_t* material = materials.const_data_ptr<std::int32_t>();
    const float* lab = colors.const_data_ptr<float>();
    std::vector<Vec3> normals(static_cast<std::size_t>(count));
    SurfacePatches patches;
    patches.triangle_area.resize(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        const auto corner = [&](int k) {
            const float* v = p + 3 * t[3 * i + k];
            return Vec3(v[0], v[1], v[2]);
        };
        const Vec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
        const float length = glm::length(cross);
        patches.triangle_area[static_cast<std::size_t>(i)] = 0.5 * length;
        normals[static_cast<std::size_t>(i)] = length > 0 ? cross / length : Vec3(0);
    }
    UnionFind sets(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            const std::int32_t code = beside[3 * i + k];
            if (code < 0) continue;
            const std::int64_t j = code / 3;
            const Vec3 apart(lab[3 * i] - lab[3 * j], lab[3 * i + 1] - lab[3 * j + 1],
                             lab[3 * i + 2] - lab[3 * j + 2]);
            if (material[i] == material[j] && glm::length(apart) < color_edge &&
                glm::dot(normals[static_cast<std::size_t>(i)],
                         normals[static_cast<std::size_t>(j)]) > crease)
                sets.join(static_cast<int>(i), static_cast<int>(j));
        }
    }
    std::vector<int> number(static_cast<std::size_t>(count), -1);
    for (std::int64_t i = 0; i < count; ++i) {
        int& patch = number[static_cast<std::size_t>(sets.find(static_cast<int>(i)))];
        if (patch < 0) {
            patch = static_cast<int>(patches.area.size());
            patches.area.push_back(0);
        }
        patches.of_triangle.push_back(patch);
        patches.area[static_cast<std::size_t>(patch)] +=
            patches.triangle_area[static_cast<std::size_t>(i)];
    }
    return patches;
}

}  // namespace item3d
