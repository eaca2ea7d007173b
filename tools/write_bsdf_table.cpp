// Writes the values of bsdf_table(), so that the build computes them once and no program does.
#include "item3d/render/kernels/bsdf.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

namespace item3d {
namespace {

constexpr int size = kernels::bsdf_table_size;
constexpr int rule_size = 10;
constexpr int azimuths = 16;

struct Rule {
    std::array<float, rule_size> points, weights;
};

/// Returns the Gauss-Legendre quadrature on [0, 1]. Newton's method finds the roots of the Legendre
/// polynomial.
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

/// Writes scale and bias of each table entry, as the values of a C++ array.
bool write_table(std::FILE* file) {
    const Rule rule = gauss_legendre();
    std::array<float, azimuths> cosines{};
    for (int i = 0; i < azimuths; ++i)
        cosines[static_cast<std::size_t>(i)] =
            static_cast<float>(std::cos(M_PI * (i + 0.5) / azimuths));
    const kernels::BsdfRule quadrature{cosines.data(), azimuths, rule.points.data(),
                                       rule.weights.data(), rule_size};
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float roughness = (static_cast<float>(y) + 0.5f) / size;
            const float n_dot_v = (static_cast<float>(x) + 0.5f) / size;
            const Vec2 value = kernels::bsdf_scale_bias(n_dot_v, roughness, quadrature);
            if (std::fprintf(file, "%af,%af,\n", value.x, value.y) < 0) return false;
        }
    return true;
}

}  // namespace
}  // namespace item3d

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(arguments[1], "w"),
                                                               std::fclose);
    return file && item3d::write_table(file.get()) && std::fflush(file.get()) == 0 ? 0 : 1;
}
