#include "item3d/field/bake/slot.h"

#include "item3d/core/parallel.h"
#include "item3d/field/bake/fill.h"

#include <algorithm>

namespace item3d {
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
    continue_weights(weight, covered, padding);
    parallel_for(
        "blend_source", image.height,
        [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < image.width; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x);
                float& edited = weight.pixels[i];
                edited = std::clamp(edited, 0.0f, 1.0f);
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
