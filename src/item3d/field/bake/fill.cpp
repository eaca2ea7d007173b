#include "item3d/field/bake/fill.h"

#include <algorithm>

namespace item3d {
namespace {

std::vector<float> means_of(const Image& image, const std::vector<std::uint8_t>& covered) {
    const auto channels = static_cast<std::size_t>(image.channels);
    std::vector<double> sums(channels, 0.0);
    double count = 0;
    for (std::size_t i = 0; i < covered.size(); ++i) {
        if (covered[i] == 0) continue;
        ++count;
        for (std::size_t c = 0; c < channels; ++c)
            sums[c] += image.pixels[i * channels + c];
    }
    std::vector<float> means;
    for (const double sum : sums)
        means.push_back(static_cast<float>(sum / std::max(count, 1.0)));
    return means;
}

/// Returns the distance of each texel from the nearest covered texel, counted in steps along rows
/// and columns.
std::vector<int> steps_to(const std::vector<std::uint8_t>& covered, int width, int height) {
    std::vector<int> steps(covered.size());
    const auto at = [&](int x, int y) -> int& {
        return steps[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)];
    };
    for (std::size_t i = 0; i < covered.size(); ++i)
        steps[i] = covered[i] ? 0 : width + height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (x > 0) at(x, y) = std::min(at(x, y), at(x - 1, y) + 1);
            if (y > 0) at(x, y) = std::min(at(x, y), at(x, y - 1) + 1);
        }
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x) {
            if (x + 1 < width) at(x, y) = std::min(at(x, y), at(x + 1, y) + 1);
            if (y + 1 < height) at(x, y) = std::min(at(x, y), at(x, y + 1) + 1);
        }
    return steps;
}

}  // namespace

void fill_uncovered(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels,
                    int layers) {
    const int width = image.width;
    const int height = image.height;
    std::vector<std::uint8_t> known = covered;  // 1: has its value, 2: is in the next layer
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    const auto for_neighbours = [&](int x, int y, const auto& f) {
        for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny) {
            for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx)
                f(nx, ny);
        }
    };
    struct Texel {
        int x, y;
    };
    std::vector<Texel> layer, next;
    const auto enqueue_around = [&](int x, int y) {
        for_neighbours(x, y, [&](int nx, int ny) {
            if (known[at(nx, ny)] != 0) return;
            known[at(nx, ny)] = 2;
            next.push_back({nx, ny});
        });
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (covered[at(x, y)] != 0) enqueue_around(x, y);
        }
    }
    const std::vector<float> means = layers > 0 ? means_of(image, covered) : std::vector<float>();
    for (int done = 0; !next.empty() && (layers == 0 || done < layers); ++done) {
        layer.swap(next);
        next.clear();
        for (const Texel texel : layer) {
            for (int c = 0; c < image.channels; ++c) {
                if ((channels >> c & 1u) == 0) continue;
                float sum = 0.0f;
                int count = 0;
                for_neighbours(texel.x, texel.y, [&](int nx, int ny) {
                    if (known[at(nx, ny)] != 1) return;
                    sum += image.at(nx, ny, c);
                    ++count;
                });
                image.at(texel.x, texel.y, c) = sum / static_cast<float>(count);
            }
        }
        for (const Texel texel : layer)
            known[at(texel.x, texel.y)] = 1;
        for (const Texel texel : layer)
            enqueue_around(texel.x, texel.y);
    }
    if (layers == 0) return;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels && known[at(x, y)] != 1; ++c)
                if ((channels >> c & 1u) != 0)
                    image.at(x, y, c) = means[static_cast<std::size_t>(c)];
        }
    }
}

void fill_invisible(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels,
                    int layers) {
    constexpr unsigned color = 7u;
    fill_uncovered(image, covered, channels & ~color, layers);
    if ((channels & color) == 0) return;
    std::vector<std::uint8_t> visible = covered;
    for (std::size_t i = 0; i < visible.size(); ++i)
        if (image.pixels[4 * i + 3] == 0) visible[i] = 0;
    fill_uncovered(image, visible, channels & color, layers);
}

void continue_weights(Image& weight, const std::vector<std::uint8_t>& covered, int layers) {
    fill_uncovered(weight, covered, 1u, layers);
    const std::vector<int> steps = steps_to(covered, weight.width, weight.height);
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (steps[i] > layers) weight.pixels[i] = 0;
}

}  // namespace item3d
