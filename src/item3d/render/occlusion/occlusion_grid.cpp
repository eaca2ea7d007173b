#include "item3d/render/occlusion/occlusion_grid.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/core/random.h"
#include "item3d/render/checks.h"
#include "item3d/render/kernels/occlusion.h"
#include "item3d/render/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

namespace item3d {
namespace {

constexpr int finest_resolution = 256;

std::int64_t grid_points(int resolution) {
    return static_cast<std::int64_t>(resolution + 1) * (resolution + 2) / 2;
}

Vec3 load(const at::Tensor& rows, std::int64_t row) {
    const float* at = rows.const_data_ptr<float>() + 3 * row;
    return Vec3(at[0], at[1], at[2]);
}

std::array<std::int64_t, 3> corners(const OcclusionGrid& grid, std::int64_t t) {
    const std::int32_t* at = grid.triangles.const_data_ptr<std::int32_t>() + 3 * t;
    return {at[0], at[1], at[2]};
}

/// Returns the number of steps along the longest edge. Each step is at most `spacing` long.
int resolution_for(const OcclusionGrid& grid, std::int64_t t, float spacing) {
    const auto c = corners(grid, t);
    float longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, glm::length(load(grid.positions, c[k]) -
                                                load(grid.positions, c[(k + 1) % 3])));
    int resolution = 1;
    while (resolution < finest_resolution && longest > spacing * static_cast<float>(resolution))
        resolution *= 2;
    return resolution;
}

/// Returns the column, the row and the remainder of a point of a triangle's grid. Divided by the
/// resolution, these are the weights of the triangle's corners.
std::array<int, 3> grid_place(int resolution, std::int64_t index) {
    int row = 0;
    while (index > resolution - row) {
        index -= resolution - row + 1;
        ++row;
    }
    const int column = static_cast<int>(index);
    return {column, row, resolution - column - row};
}

/// Returns the weighted sum of three corners' values in an order that does not depend on the
/// triangle, so that triangles which share an edge get the same bits along it.
Vec3 ordered_sum(std::array<Vec3, 3> values, std::array<int, 3> weights, int resolution) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::tie(values[a].x, values[a].y, values[a].z, weights[a]) <
               std::tie(values[b].x, values[b].y, values[b].z, weights[b]);
    });
    Vec3 sum(0.0f);
    for (const std::size_t k : order)
        if (weights[k] != 0)
            sum += values[k] * (static_cast<float>(weights[k]) / static_cast<float>(resolution));
    return sum;
}

struct Corners {
    std::array<Vec3, 3> positions, normals;
    Vec3 face;
};

Corners load_corners(const OcclusionGrid& grid, std::int64_t t) {
    Corners out;
    const auto c = corners(grid, t);
    for (std::size_t k = 0; k < 3; ++k) {
        out.positions[k] = load(grid.positions, c[k]);
        out.normals[k] = load(grid.normals, c[k]);
    }
    const glm::dvec3 a(out.positions[0]), b(out.positions[1]), d(out.positions[2]);
    const glm::dvec3 face = glm::cross(b - a, d - a);
    const double length = glm::length(face);
    out.face = length > 0 ? Vec3(face / length) : Vec3(0.0f);
    return out;
}

/// Returns the unit normal. Where the vertices have no normal, it is the triangle's own.
Vec3 normal_at(const Corners& c, std::array<int, 3> place, int resolution) {
    const Vec3 normal = ordered_sum(c.normals, place, resolution);
    const float length = glm::length(normal);
    return length > 1e-10f ? normal / length : c.face;
}

std::uint64_t hash(Vec3 position, Vec3 normal) {
    std::uint64_t bits = 0;
    // Adding zero turns -0 into 0.
    for (const float value : {position.x, position.y, position.z, normal.x, normal.y, normal.z})
        bits = mix_bits(bits ^ std::bit_cast<std::uint32_t>(value + 0.0f));
    return bits;
}

void choose_resolutions(OcclusionGrid& grid, float spacing, std::int64_t max_points) {
    const std::int64_t count = grid.triangles.size(0);
    grid.resolution.resize(static_cast<std::size_t>(count));
    for (float step = spacing * grid.diagonal;; step *= 2) {
        parallel_for("occlusion resolution", count, [&](std::int64_t t) {
            grid.resolution[static_cast<std::size_t>(t)] = resolution_for(grid, t, step);
        });
        // An inner point belongs to one triangle, and several triangles share a point on an edge. A
        // triangle therefore counts about resolution^2 / 2 points.
        double points = 0;
        bool coarsest = true;
        for (const std::int32_t resolution : grid.resolution) {
            points += 0.5 * resolution * resolution;
            coarsest = coarsest && resolution == 1;
        }
        if (coarsest || points <= static_cast<double>(max_points)) return;
    }
}

}  // namespace

OcclusionGrid::Point OcclusionGrid::point(std::int64_t index) const {
    const auto t = static_cast<std::size_t>(triangle[static_cast<std::size_t>(index)]);
    const int steps = resolution[t];
    const Corners c = load_corners(*this, static_cast<std::int64_t>(t));
    const auto place = grid_place(steps, index - first[t]);
    const Vec3 center = (c.positions[0] + c.positions[1] + c.positions[2]) / 3.0f;
    const Vec3 on_edge = ordered_sum(c.positions, place, steps);
    constexpr float inwards = 0.05f;  // as a fraction of a step
    Point point;
    point.position = on_edge + (inwards / static_cast<float>(steps)) * (center - on_edge);
    point.normal = normal_at(c, place, steps);
    point.face = c.face;
    return point;
}

OcclusionGrid make_occlusion_grid(const Geometry& geometry, float spacing,
                                  std::int64_t max_points) {
    constexpr const char* op = "Occlusion";
    const auto on_cpu = [](const at::Tensor& tensor) { return tensor.detach().cpu(); };
    OcclusionGrid grid;
    grid.positions = checked(op, "positions", on_cpu(geometry.positions), at::kFloat, {-1, 3});
    grid.normals =
        checked(op, "normals", on_cpu(geometry.normals), at::kFloat, {grid.positions.size(0), 3});
    grid.triangles = checked(op, "triangles", on_cpu(geometry.triangles), at::kInt, {-1, 3});
    const std::int64_t count = grid.triangles.size(0);
    grid.neighbours = geometry.neighbours.defined()
                          ? on_cpu(geometry.neighbours).contiguous()
                          : triangle_neighbours(grid.positions, grid.triangles);
    ITEM3D_CHECK(spacing > 0 && max_points > 0, "Occlusion: spacing and max_points above 0");
    if (grid.positions.size(0) > 0) {
        const at::Tensor low = std::get<0>(grid.positions.min(0));
        const at::Tensor high = std::get<0>(grid.positions.max(0));
        grid.diagonal = (high - low).norm().item<float>();
        grid.farthest = grid.positions.abs().max().item<float>();
    }
    choose_resolutions(grid, spacing, max_points);

    grid.first.resize(static_cast<std::size_t>(count) + 1, 0);
    for (std::size_t t = 0; t < static_cast<std::size_t>(count); ++t)
        grid.first[t + 1] = grid.first[t] + grid_points(grid.resolution[t]);
    const auto points = static_cast<std::size_t>(grid.points());
    grid.triangle.resize(points);
    grid.key.resize(points);
    parallel_for(
        "occlusion points", count,
        [&](std::int64_t t) {
            const auto at = static_cast<std::size_t>(t);
            const Corners c = load_corners(grid, t);
            for (std::int64_t i = grid.first[at]; i < grid.first[at + 1]; ++i) {
                const int steps = grid.resolution[at];
                const auto place = grid_place(steps, i - grid.first[at]);
                grid.triangle[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(t);
                grid.key[static_cast<std::size_t>(i)] =
                    hash(ordered_sum(c.positions, place, steps), normal_at(c, place, steps));
            }
        },
        64);

    // A 64-bit hash stands for position and normal. Two different points whose hashes collide share
    // a value; among ten million points the probability of a collision is 1 in 400,000.
    grid.member.resize(points);
    std::iota(grid.member.begin(), grid.member.end(), std::int64_t{0});
    const auto key = [&](std::int64_t i) { return grid.key[static_cast<std::size_t>(i)]; };
    std::sort(grid.member.begin(), grid.member.end(), [&](std::int64_t a, std::int64_t b) {
        return key(a) != key(b) ? key(a) < key(b) : a < b;
    });
    for (std::size_t i = 0; i < points; ++i)
        if (i == 0 || key(grid.member[i]) != key(grid.member[i - 1]))
            grid.begin.push_back(static_cast<std::int64_t>(i));
    grid.begin.push_back(static_cast<std::int64_t>(points));
    return grid;
}

void join_grids(const OcclusionGrid& grid, std::uint8_t* values) {
    const std::int32_t* neighbours = grid.neighbours.const_data_ptr<std::int32_t>();
    parallel_for(
        "join occlusion grids", grid.triangles.size(0),
        [&](std::int64_t t) {
            const int steps = grid.resolution[static_cast<std::size_t>(t)];
            for (int facing = 0; facing < 3; ++facing) {
                const std::int32_t neighbour = neighbours[3 * t + facing];
                if (neighbour < 0) continue;
                const int theirs = grid.resolution[static_cast<std::size_t>(neighbour / 3)];
                if (theirs >= steps) continue;
                const int stride = steps / theirs;
                const auto at = [&](int step) {
                    int place[3] = {0, 0, 0};
                    place[(facing + 1) % 3] = steps - step;
                    place[(facing + 2) % 3] = step;
                    return values + 2 * (grid.first[static_cast<std::size_t>(t)] +
                                         kernels::grid_index(steps, place[0], place[1]));
                };
                for (int step = 0; step < steps; ++step) {
                    const int before = step / stride * stride;
                    if (before == step) continue;
                    for (int side = 0; side < 2; ++side)
                        at(step)[side] = static_cast<std::uint8_t>(
                            (at(before)[side] * (before + stride - step) +
                             at(before + stride)[side] * (step - before) + stride / 2) /
                            stride);
                }
            }
        },
        64);
}

}  // namespace item3d
