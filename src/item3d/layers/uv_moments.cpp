#include "item3d/layers/uv_moments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace item3d {
namespace {

constexpr double tolerance = 1e-4;
constexpr std::size_t count = 11;

using Corners = std::array<double, 3>;  ///< corner values of a linear function

double sum(const Corners& f) {
    return f[0] + f[1] + f[2];
}

/// Returns the mean of the product of f and g over a triangle.
double mean(const Corners& f, const Corners& g) {
    return (sum(f) * sum(g) + f[0] * g[0] + f[1] * g[1] + f[2] * g[2]) / 12;
}

void add_primitive(const Primitive& primitive, const Vec3& low, float diagonal,
                   std::array<double, count>& sums, double& area) {
    for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
        std::array<Vec3, 3> place;
        Corners u, v;
        std::array<Corners, 3> at;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t vertex = primitive.indices[t + k];
            place[k] = (primitive.positions[vertex] - low) / diagonal;
            u[k] = primitive.uvs[vertex].x;
            v[k] = primitive.uvs[vertex].y;
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis][k] = place[k][static_cast<int>(axis)];
        }
        const double weight =
            0.5 * glm::length(glm::cross(place[1] - place[0], place[2] - place[0]));
        area += weight;
        const std::array<double, count> values{sum(u) / 3,     sum(v) / 3,     mean(u, u),
                                               mean(v, v),     mean(u, v),     mean(u, at[0]),
                                               mean(u, at[1]), mean(u, at[2]), mean(v, at[0]),
                                               mean(v, at[1]), mean(v, at[2])};
        for (std::size_t i = 0; i < count; ++i)
            sums[i] += weight * values[i];
    }
}

}  // namespace

std::vector<double> uv_moments(const Model& model, int material) {
    const auto [low, high] = model.bounds();
    const float diagonal = std::max(glm::length(high - low), 1e-12f);
    std::array<double, count> sums{};
    double area = 0;
    for (const Primitive& primitive : model.primitives)
        if (primitive.material == material && !primitive.uvs.empty())
            add_primitive(primitive, low, diagonal, sums, area);
    if (!(area > 0)) return {};
    for (double& value : sums)
        value /= area;
    return {sums.begin(), sums.end()};
}

bool same_uvs(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](double x, double y) { return std::abs(x - y) <= tolerance; });
}

}  // namespace item3d
