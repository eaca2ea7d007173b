// An equirectangular light to draw directions from, as often as they are bright.
#pragma once

#include "item3d/scene/environment.h"
#include "item3d/scene/image.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {

class OcclusionLight {
  public:
    /// light: RGB (more channels are ignored), linear. Negative and unbounded values count as 0.
    explicit OcclusionLight(const Image& light) : width_(light.width), height_(light.height) {
        luminance_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
        double sum = 0;
        for (int y = 0; y < height_; ++y) {
            const double top = std::cos(pi * static_cast<double>(y) / height_);
            const double bottom = std::cos(pi * static_cast<double>(y + 1) / height_);
            const double solid_angle = 2.0 * pi / width_ * (top - bottom);
            for (int x = 0; x < width_; ++x) {
                const auto channel = [&](int c) {
                    return light.at(x, y, std::min(c, light.channels - 1));
                };
                const float value =
                    0.2126f * channel(0) + 0.7152f * channel(1) + 0.0722f * channel(2);
                luminance_.push_back(std::isfinite(value) && value > 0 ? value : 0.0f);
                sum += luminance_.back() * solid_angle;
                sums_.push_back(sum);
            }
        }
    }

    bool dark() const { return !(sums_.back() > 0); }
    /// Integral of luminance over all directions: luminance(d) / total() is the density of `d`.
    float total() const { return static_cast<float>(sums_.back()); }

    float luminance(Vec3 direction) const {
        const float u = std::atan2(direction.x, -direction.z) / (2 * pi) + 0.5f;
        const float v = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / pi;
        const int x = std::min(static_cast<int>(u * static_cast<float>(width_)), width_ - 1);
        const int y = std::min(static_cast<int>(v * static_cast<float>(height_)), height_ - 1);
        return luminance_[texel(x, y)];
    }

    /// square: in [0, 1)^2.
    Vec3 direction(Vec2 square) const {
        const double wanted = square.x * sums_.back();
        const auto found = std::upper_bound(sums_.begin(), sums_.end(), wanted);
        const auto index =
            static_cast<std::size_t>(std::min(found, sums_.end() - 1) - sums_.begin());
        const int x = static_cast<int>(index % static_cast<std::size_t>(width_));
        const int y = static_cast<int>(index / static_cast<std::size_t>(width_));
        const double before = index > 0 ? sums_[index - 1] : 0.0;
        const double part =
            sums_[index] > before ? (wanted - before) / (sums_[index] - before) : 0.5;
        // Even in the cosine is even in solid angle.
        const double top = std::cos(pi * static_cast<double>(y) / height_);
        const double bottom = std::cos(pi * static_cast<double>(y + 1) / height_);
        const double cosine = top + (bottom - top) * static_cast<double>(square.y);
        return equirectangular_direction(
            static_cast<float>((x + std::clamp(part, 0.0, 1.0)) / width_),
            static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)) / pi));
    }

  private:
    std::size_t texel(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_, height_;
    std::vector<float> luminance_;
    std::vector<double> sums_;
};

}  // namespace item3d
