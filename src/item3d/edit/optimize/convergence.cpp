#include "item3d/edit/optimize/convergence.h"

#include <cmath>

namespace item3d {
namespace {

/// Number of iterations in a mean. The lengths depend on the noise level, and the mean averages
/// over the levels.
constexpr std::int64_t window = 50;
constexpr std::int64_t min_iterations = 3 * window;
constexpr double still = 0.9;  ///< smallest ratio of the second half's mean to the first's

/// Returns the mean of the finite values, because an overflow in bf16 must not change the result.
double mean(const std::vector<float>& values, std::int64_t begin, std::int64_t end) {
    double sum = 0;
    int count = 0;
    for (std::int64_t i = begin; i < end; ++i) {
        const float value = values[static_cast<std::size_t>(i)];
        if (!std::isfinite(value)) continue;
        sum += value;
        ++count;
    }
    return sum / count;
}

}  // namespace

std::optional<std::int64_t> converged_at(const std::vector<float>& lengths, double part) {
    const auto count = static_cast<std::int64_t>(lengths.size());
    if (part <= 0 || count < min_iterations) return std::nullopt;
    const double bound = part * mean(lengths, 0, window);
    for (std::int64_t end = min_iterations; end <= count; ++end) {
        const double first = mean(lengths, end - window, end - window / 2);
        const double second = mean(lengths, end - window / 2, end);
        if (first <= bound && second <= bound && second >= still * first) return end;
    }
    return std::nullopt;
}

}  // namespace item3d
