#include "item3d/field/bake/painted_color.h"

#include <algorithm>

namespace item3d {
namespace {

/// The two texels around a position on one axis, and the weight of the second.
struct Between {
    int first, second;
    float share;

    Between(int texel, int texels, int count) {
        const float place =
            std::clamp((static_cast<float>(texel) + 0.5f) * static_cast<float>(count) /
                               static_cast<float>(texels) -
                           0.5f,
                       0.0f, static_cast<float>(count - 1));
        first = static_cast<int>(place);
        second = std::min(first + 1, count - 1);
        share = place - static_cast<float>(first);
    }
};

}  // namespace

Vec3 color_at_texel(const Image& painted, int x, int y, TextureSize size) {
    const Between across(x, size.first, painted.width), down(y, size.second, painted.height);
    Vec3 color;
    for (int c = 0; c < 3; ++c) {
        const auto row = [&](int line) {
            return painted.at(across.first, line, c) * (1 - across.share) +
                   painted.at(across.second, line, c) * across.share;
        };
        color[c] = std::clamp(row(down.first) * (1 - down.share) + row(down.second) * down.share,
                              0.0f, 1.0f);
    }
    return color;
}

}  // namespace item3d
