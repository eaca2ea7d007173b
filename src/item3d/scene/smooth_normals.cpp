#include "item3d/scene/smooth_normals.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace item3d {

std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::uint32_t> indices) {
    using DVec3 = glm::dvec3;
    const auto key = [&](std::uint32_t i) {
        return std::array{positions[i].x, positions[i].y, positions[i].z};
    };
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto left = key(a);
        const auto right = key(b);
        return left != right ? left < right : a < b;
    });
    // place[i]: which distinct position vertex i stands at.
    std::vector<std::uint32_t> place(positions.size());
    std::uint32_t places = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && key(order[i]) != key(order[i - 1])) ++places;
        place[order[i]] = places;
    }

    std::vector<DVec3> sums(positions.empty() ? 0 : places + 1, DVec3(0.0));
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const DVec3 a(positions[indices[t]]);
        const DVec3 b(positions[indices[t + 1]]);
        const DVec3 c(positions[indices[t + 2]]);
        // Twice the area times the unit normal.
        const DVec3 face = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k)
            sums[place[indices[t + k]]] += face;
    }
    std::vector<Vec3> normals(positions.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const DVec3 sum = sums[place[i]];
        const double length = glm::length(sum);
        normals[i] = length > 0.0 ? Vec3(sum / length) : Vec3(0.0f, 0.0f, 1.0f);
    }
    return normals;
}

}  // namespace item3d
