#include "item3d/prior/data/shapes/lathe.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Returns the slopes at the points. At inner points they are weighted harmonic means, so that the
/// curve is monotone.
std::vector<float> monotone_slopes(const std::vector<float>& x, const std::vector<float>& y) {
    const std::size_t count = x.size();
    std::vector<float> step(count - 1), secant(count - 1), slope(count, 0.0f);
    for (std::size_t i = 0; i + 1 < count; ++i) {
        step[i] = x[i + 1] - x[i];
        secant[i] = (y[i + 1] - y[i]) / step[i];
    }
    slope.front() = secant.front();
    slope.back() = secant.back();
    for (std::size_t i = 1; i + 1 < count; ++i) {
        if (secant[i - 1] * secant[i] <= 0) continue;
        const float w1 = 2 * step[i] + step[i - 1];
        const float w2 = step[i] + 2 * step[i - 1];
        slope[i] = (w1 + w2) / (w1 / secant[i - 1] + w2 / secant[i]);
    }
    return slope;
}

}  // namespace

float interpolate_monotone(const std::vector<float>& x, const std::vector<float>& y, float at) {
    ITEM3D_CHECK(x.size() == y.size() && x.size() >= 2, "a curve needs at least two points");
    const std::vector<float> slope = monotone_slopes(x, y);
    const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
    const auto i = static_cast<std::size_t>(above - x.begin()) - 1;
    const float h = x[i + 1] - x[i];
    const float t = std::clamp((at - x[i]) / h, 0.0f, 1.0f);
    const float t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * y[i] + (t3 - 2 * t2 + t) * h * slope[i] +
           (-2 * t3 + 3 * t2) * y[i + 1] + (t3 - t2) * h * slope[i + 1];
}

Lathe::Lathe(const std::vector<float>& heights, const std::vector<float>& radii,
             const LatheOptions& options)
    : bottom_(heights.front()), top_(heights.back()), options_(options) {
    for (int i = 0; i < samples; ++i) {
        const float height = bottom_ + (top_ - bottom_) * static_cast<float>(i) / (samples - 1);
        radius_[static_cast<std::size_t>(i)] = interpolate_monotone(heights, radii, height);
    }
}

float Lathe::distance(const Vec3& p) const {
    const float r = std::hypot(p.x, p.z);
    const float position = std::clamp((p.y - bottom_) / (top_ - bottom_) * (samples - 1), 0.0f,
                                      static_cast<float>(samples - 1) - 1e-3f);
    const auto i = static_cast<std::size_t>(position);
    const float weight = position - static_cast<float>(i);
    const float radius = radius_[i] * (1 - weight) + radius_[i + 1] * weight;
    const float ends = std::max(p.y - top_, bottom_ - p.y);
    float distance = std::max((r - radius) * options_.steepness, ends);
    if (options_.wall > 0) {
        const float hollow = std::max((r - (radius - options_.wall)) * options_.steepness,
                                      (bottom_ + options_.wall) - p.y);
        distance = std::max(distance, -hollow);
    }
    return distance;
}

}  // namespace item3d
