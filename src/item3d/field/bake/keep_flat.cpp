#include "item3d/field/bake/keep_flat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace item3d {
namespace {

/// Largest number of colours in a flat texture. A photograph has more colours, and a drawing with
/// soft edges has fewer.
constexpr std::size_t max_colors = 1024;

struct Statistics {
    double count = 0;
    std::array<double, 3> sum{}, squares{};

    double mean(int c) const { return sum[static_cast<std::size_t>(c)] / count; }
    double deviation(int c) const {
        const double square = squares[static_cast<std::size_t>(c)] / count - mean(c) * mean(c);
        return std::sqrt(std::max(square, 0.0));
    }
};

std::uint32_t color_at(const Image& image, std::size_t texel) {
    std::uint32_t color = 0;
    for (int c = 0; c < image.channels; ++c) {
        const float value = image.pixels[texel * static_cast<std::size_t>(image.channels) +
                                         static_cast<std::size_t>(c)];
        color = color << 8 | static_cast<std::uint32_t>(std::lround(255 * value));
    }
    return color;
}

}  // namespace

void keep_flat(Image& image, const Image& source, const std::vector<std::uint8_t>& covered,
               unsigned channels, float blotch) {
    if (channels == 0) return;
    const auto stride = static_cast<std::size_t>(image.channels);
    const int colors = std::min(image.channels, 3);
    std::unordered_map<std::uint32_t, Statistics> found;
    for (std::size_t i = 0; i < covered.size(); ++i) {
        if (covered[i] == 0) continue;
        Statistics& statistics = found[color_at(source, i)];
        if (found.size() > max_colors) return;
        ++statistics.count;
        for (int c = 0; c < colors; ++c) {
            const double value = image.pixels[i * stride + static_cast<std::size_t>(c)];
            statistics.sum[static_cast<std::size_t>(c)] += value;
            statistics.squares[static_cast<std::size_t>(c)] += value * value;
        }
    }
    for (std::size_t i = 0; i < covered.size(); ++i) {
        if (covered[i] == 0) continue;
        const Statistics& statistics = found.at(color_at(source, i));
        for (int c = 0; c < colors; ++c) {
            if ((channels >> c & 1u) != 0 && statistics.deviation(c) < blotch)
                image.pixels[i * stride + static_cast<std::size_t>(c)] =
                    static_cast<float>(statistics.mean(c));
        }
    }
}

}  // namespace item3d
