#include "item3d/core/parallel.h"
#include "item3d/render/environment_light.h"
#include "item3d/render/kernels/bsdf.h"

#include <array>
#include <cmath>

namespace item3d {
namespace {

constexpr int table_size = 256;
constexpr int rule_size = 10;
constexpr int azimuths = 16;

struct Rule {
    std::array<float, rule_size> points, weights;
};

/// Gauss-Legendre quadrature on [0, 1]: roots of the Legendre polynomial by Newton's method.
Rule gauss_legendre() {
    Rule rule{};
    for (int i = 0; i < rule_size; ++i) {
        double x = std::cos(M_PI * (i + 0.75) / (rule_size + 0.5)), derivative = 1;
        for (int step = 0; step < 20; ++step) {
            double previous = 1, value = x;
            for (int degree = 2; degree <= rule_size; ++degree) {
                const double next =
                    ((2 * degree - 1) * x * value - (degree - 1) * previous) / degree;
                previous = value;
                value = next;
            }
            derivative = rule_size * (x * value - previous) / (x * x - 1);
            x -= value / derivative;
        }
        rule.points[static_cast<std::size_t>(i)] = static_cast<float>(0.5 * (1 - x));
        rule.weights[static_cast<std::size_t>(i)] =
            static_cast<float>(1 / ((1 - x * x) * derivative * derivative));
    }
    return rule;
}

torch::Tensor compute_table() {
    const Rule rule = gauss_legendre();
    std::array<float, azimuths> cosines{};
    for (int i = 0; i < azimuths; ++i)
        cosines[static_cast<std::size_t>(i)] =
            static_cast<float>(std::cos(M_PI * (i + 0.5) / azimuths));
    const kernels::BsdfRule quadrature{cosines.data(), azimuths, rule.points.data(),
                                       rule.weights.data(), rule_size};
    torch::Tensor table = torch::empty({table_size, table_size, 2}, torch::kFloat32);
    float* out = table.data_ptr<float>();
    parallel_for("bsdf_table", table_size * table_size, [&](std::int64_t i) {
        const float roughness = (static_cast<float>(i / table_size) + 0.5f) / table_size;
        const float n_dot_v = (static_cast<float>(i % table_size) + 0.5f) / table_size;
        const Vec2 value = kernels::bsdf_scale_bias(n_dot_v, roughness, quadrature);
        out[2 * i] = value.x;
        out[2 * i + 1] = value.y;
    });
    return table;
}

}  // namespace

const torch::Tensor& bsdf_table() {
    static const torch::Tensor table = compute_table();
    return table;
}

}  // namespace item3d
