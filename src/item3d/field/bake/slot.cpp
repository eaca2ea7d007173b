#include "item3d/field/bake/slot.h"

#include "item3d/core/parallel.h"
#include "item3d/field/bake/fill.h"

#include <algorithm>

namespace item3d {
namespace {

/// From each texel to the nearest covered one, along rows and columns.
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

void Slot::open(int channels, bool in_part) {
    image = Image(size.first, size.second, channels);
    covered.assign(static_cast<std::size_t>(size.first) * static_cast<std::size_t>(size.second), 0);
    if (in_part) weight = Image(size.first, size.second, 1);
}

void Slot::keep_source() {
    source = image;
}

void Slot::cover(int x, int y, float edited) {
    covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
            static_cast<std::size_t>(x)] = 1;
    if (!weight.empty()) weight.at(x, y, 0) = edited;
}

void Slot::blend_with_source(bool is_copied, int padding) {
    if (source.empty()) return;
    if (!is_copied) fill_uncovered(source, covered, ~0u, padding);
    if (weight.empty()) return;
    // Beyond the padding nothing shows a texel: it stays.
    const std::vector<int> steps = steps_to(covered, image.width, image.height);
    fill_uncovered(weight, covered, 1u, padding);
    parallel_for(
        "blend_source", image.height,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < image.width; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x);
                const float edited =
                    steps[i] <= padding ? std::clamp(weight.pixels[i], 0.0f, 1.0f) : 0.0f;
                weight.pixels[i] = edited;
                if (edited == 1) continue;
                for (int c = 0; c < image.channels; ++c) {
                    const float was = source.at(x, y, c);
                    float& now = image.at(x, y, c);
                    now = edited == 0 ? was : was + edited * (now - was);
                }
            }
        },
        16);
}

}  // namespace item3d
