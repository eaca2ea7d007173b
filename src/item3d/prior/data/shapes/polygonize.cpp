#include "item3d/prior/data/shapes/polygonize.h"

#include "item3d/core/error.h"

#include <array>
#include <cmath>
#include <limits>

namespace item3d {
namespace {

constexpr int block = 8;

/// Distances at the corners of the grid, evaluated only near the surface.
class Grid {
  public:
    Grid(const SignedDistance& distance, int resolution, float extent)
        : corners_(resolution + 1),
          cell_(2 * extent / static_cast<float>(resolution)),
          extent_(extent) {
        values_.assign(static_cast<std::size_t>(corners_) * corners_ * corners_,
                       std::numeric_limits<float>::max());
        for (int z = 0; z < corners_; z += block)
            for (int y = 0; y < corners_; y += block)
                for (int x = 0; x < corners_; x += block)
                    fill_block(distance, x, y, z);
    }

    int corners() const { return corners_; }
    Vec3 point(int x, int y, int z) const { return Vec3(x, y, z) * cell_ - extent_; }
    float at(int x, int y, int z) const { return values_[index(x, y, z)]; }
    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * corners_ + y) * corners_ + x;
    }

  private:
    void fill_block(const SignedDistance& distance, int x0, int y0, int z0) {
        const Vec3 middle = point(x0, y0, z0) + cell_ * block * .5f;
        const float at_middle = distance(middle);
        const float reach = 1.5f * cell_ * (block * .5f + 1) * std::sqrt(3.0f);
        const bool empty = std::abs(at_middle) > reach;
        for (int z = z0; z < std::min(z0 + block, corners_); ++z)
            for (int y = y0; y < std::min(y0 + block, corners_); ++y)
                for (int x = x0; x < std::min(x0 + block, corners_); ++x)
                    values_[index(x, y, z)] = empty ? at_middle : distance(point(x, y, z));
    }

    int corners_;
    float cell_;
    float extent_;
    std::vector<float> values_;
};

/// Computes the mean of the surface's crossings on a cell's edges. Returns false if there are none.
bool cell_vertex(const Grid& grid, int x, int y, int z, Vec3& vertex) {
    std::array<float, 8> value;
    int inside = 0;
    for (int i = 0; i < 8; ++i) {
        value[static_cast<std::size_t>(i)] = grid.at(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
        inside += value[static_cast<std::size_t>(i)] < 0;
    }
    if (inside == 0 || inside == 8) return false;
    Vec3 sum(0.0f);
    int crossings = 0;
    for (int i = 0; i < 8; ++i) {
        for (int axis = 1; axis < 8; axis <<= 1) {
            if (i & axis) continue;
            const float a = value[static_cast<std::size_t>(i)];
            const float b = value[static_cast<std::size_t>(i | axis)];
            if ((a < 0) == (b < 0)) continue;
            const int j = i | axis;
            const Vec3 p = grid.point(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
            const Vec3 q = grid.point(x + (j & 1), y + (j >> 1 & 1), z + (j >> 2));
            sum += glm::mix(p, q, a / (a - b));
            ++crossings;
        }
    }
    vertex = sum / static_cast<float>(crossings);
    return true;
}

Vec3 gradient(const SignedDistance& distance, const Vec3& p) {
    // Four samples on a tetrahedron suffice; central differences need six.
    constexpr float h = .004f;
    const std::array<Vec3, 4> taps{Vec3(1, -1, -1), Vec3(-1, -1, 1), Vec3(-1, 1, -1),
                                   Vec3(1, 1, 1)};
    Vec3 sum(0.0f);
    for (const Vec3& tap : taps)
        sum += tap * distance(p + h * tap);
    const float length = glm::length(sum);
    return length > 1e-12f ? sum / length : Vec3(0, 1, 0);
}

void add_quad(std::vector<std::uint32_t>& indices, std::array<std::uint32_t, 4> q, bool flip) {
    if (flip) std::swap(q[1], q[3]);
    for (const std::size_t corner : {0, 1, 2, 0, 2, 3})
        indices.push_back(q[corner]);
}

}  // namespace

Polygonized polygonize(const SignedDistance& distance, int resolution, float extent) {
    const Grid grid(distance, resolution, extent);
    constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
    const int corners = grid.corners();
    std::vector<std::uint32_t> vertex_of(static_cast<std::size_t>(corners) * corners * corners,
                                         none);
    Polygonized result;
    Primitive& mesh = result.primitive;
    for (int z = 0; z + 1 < corners; ++z) {
        for (int y = 0; y + 1 < corners; ++y) {
            for (int x = 0; x + 1 < corners; ++x) {
                Vec3 vertex;
                if (!cell_vertex(grid, x, y, z, vertex)) continue;
                vertex_of[grid.index(x, y, z)] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.push_back(vertex);
                mesh.normals.push_back(gradient(distance, vertex));
            }
        }
    }
    ITEM3D_CHECK(!mesh.positions.empty(), "the shape has no surface inside the grid");

    // Every crossed grid edge is shared by four cells, whose vertices form a quad.
    for (int z = 1; z + 1 < corners; ++z) {
        for (int y = 1; y + 1 < corners; ++y) {
            for (int x = 1; x + 1 < corners; ++x) {
                const bool inside = grid.at(x, y, z) < 0;
                const auto cell = [&](int dx, int dy, int dz) {
                    return vertex_of[grid.index(x - dx, y - dy, z - dz)];
                };
                if (inside != (grid.at(x + 1, y, z) < 0))
                    add_quad(mesh.indices,
                             {cell(0, 0, 0), cell(0, 1, 0), cell(0, 1, 1), cell(0, 0, 1)}, !inside);
                if (inside != (grid.at(x, y + 1, z) < 0))
                    add_quad(mesh.indices,
                             {cell(0, 0, 0), cell(0, 0, 1), cell(1, 0, 1), cell(1, 0, 0)}, !inside);
                if (inside != (grid.at(x, y, z + 1) < 0))
                    add_quad(mesh.indices,
                             {cell(0, 0, 0), cell(1, 0, 0), cell(1, 1, 0), cell(0, 1, 0)}, !inside);
            }
        }
    }

    Vec3 low = mesh.positions[0], high = mesh.positions[0];
    for (const Vec3& p : mesh.positions)
        low = glm::min(low, p), high = glm::max(high, p);
    result.center = (low + high) * .5f;
    float farthest = 0;
    for (const Vec3& p : mesh.positions)
        farthest = std::max(farthest, glm::length(p - result.center));
    result.scale = farthest;
    for (Vec3& p : mesh.positions)
        p = (p - result.center) / farthest;
    return result;
}

}  // namespace item3d
