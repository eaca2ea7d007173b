// An equirectangular light as a distribution of directions, with density proportional to luminance.
#pragma once

#include "item3d/lighting/environment.h"
#include "item3d/scene/image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace item3d {

class OcclusionLight {
  public:
    /// light: linear RGB; further channels are ignored. Negative and infinite values count as 0.
    explicit OcclusionLight(const Image& light) : width_(light.width), height_(light.height) {
        for (int y = 0; y <= height_; ++y)
            row_cosine_.push_back(std::cos(pi * static_cast<double>(y) / height_));
        luminance_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
        double sum = 0;
        for (std::size_t y = 0; y + 1 < row_cosine_.size(); ++y) {
            const double solid_angle = 2.0 * pi / width_ * (row_cosine_[y] - row_cosine_[y + 1]);
            for (int x = 0; x < width_; ++x) {
                const auto channel = [&](int c) {
                    return light.at(x, static_cast<int>(y), std::min(c, light.channels - 1));
                };
                const float value =
                    0.2126f * channel(0) + 0.7152f * channel(1) + 0.0722f * channel(2);
                luminance_.push_back(std::isfinite(value) && value > 0 ? value : 0.0f);
                sum += luminance_.back() * solid_angle;
                sums_.push_back(sum);
            }
        }
        for (std::size_t part = 0; part <= guide_parts; ++part)
            guide_.push_back(
                first_above(sum * static_cast<double>(part) / guide_parts, 0, sums_.size()));
    }

    bool dark() const { return !(sums_.back() > 0); }
    /// Returns the integral of luminance over all directions: luminance(d) / total() is the density
    /// of `d`.
    float total() const { return static_cast<float>(sums_.back()); }

    float luminance(Vec3 direction) const {
        const float u = std::atan2(direction.x, -direction.z) / (2 * pi) + 0.5f;
        const float v = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / pi;
        const int x = std::min(static_cast<int>(u * static_cast<float>(width_)), width_ - 1);
        const int y = std::min(static_cast<int>(v * static_cast<float>(height_)), height_ - 1);
        return luminance_[texel(x, y)];
    }

    struct Drawn {
        Vec3 direction;
        float luminance;
    };
    /// Draws a direction. square: random point, uniform in [0, 1)^2.
    Drawn draw(Vec2 square) const {
        const double wanted = square.x * sums_.back();
        const auto part = static_cast<std::size_t>(square.x * static_cast<float>(guide_parts));
        const std::size_t index = std::min(
            first_above(wanted, guide_[part], std::min(guide_[part + 1] + 1, sums_.size())),
            sums_.size() - 1);
        const std::size_t x = index % static_cast<std::size_t>(width_);
        const std::size_t y = index / static_cast<std::size_t>(width_);
        const double before = index > 0 ? sums_[index - 1] : 0.0;
        const double along =
            sums_[index] > before ? (wanted - before) / (sums_[index] - before) : 0.5;
        // A uniform distribution of the cosine is uniform in solid angle.
        const double cosine =
            row_cosine_[y] + (row_cosine_[y + 1] - row_cosine_[y]) * static_cast<double>(square.y);
        const auto sine = static_cast<float>(std::sqrt(std::max(0.0, 1 - cosine * cosine)));
        const auto u =
            static_cast<float>((static_cast<double>(x) + std::clamp(along, 0.0, 1.0)) / width_);
        // equirectangular_direction() would compute the polar angle and then its cosine, which is
        // known already.
        const float azimuth = 2 * pi * (u - 0.5f);
        return {
            Vec3(sine * std::sin(azimuth), static_cast<float>(cosine), -sine * std::cos(azimuth)),
            luminance_[index]};
    }

  private:
    /// Number of parts, a power of two, so that its product with a number in [0, 1) is exact.
    static constexpr std::size_t guide_parts = 4096;

    /// Returns the first texel in [begin, end) whose cumulative light exceeds `wanted`; otherwise
    /// `end`.
    std::size_t first_above(double wanted, std::size_t begin, std::size_t end) const {
        const auto first = sums_.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto last = sums_.begin() + static_cast<std::ptrdiff_t>(end);
        return static_cast<std::size_t>(std::upper_bound(first, last, wanted) - sums_.begin());
    }
    std::size_t texel(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_, height_;
    std::vector<double> row_cosine_;  ///< cosine of the polar angle of each row's top
    std::vector<float> luminance_;
    std::vector<double> sums_;        ///< cumulative luminance times solid angle, by texel
    std::vector<std::size_t> guide_;  ///< first texel of the search, for each of guide_parts
};

}  // namespace item3d
