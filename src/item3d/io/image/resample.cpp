#include "item3d/io/image/resample.h"

#include <algorithm>
#include <cmath>

namespace item3d {

Image resample(const Image& image, int width, int height) {
    if (image.width == width && image.height == height) return image;
    Image result(width, height, image.channels);
    const auto position = [](int i, int to, int from) {
        const float at =
            (static_cast<float>(i) + 0.5f) * static_cast<float>(from) / static_cast<float>(to);
        return std::clamp(at - 0.5f, 0.0f, static_cast<float>(from - 1));
    };
    for (int y = 0; y < height; ++y) {
        const float v = position(y, height, image.height);
        const int y0 = static_cast<int>(v);
        const int y1 = std::min(y0 + 1, image.height - 1);
        for (int x = 0; x < width; ++x) {
            const float u = position(x, width, image.width);
            const int x0 = static_cast<int>(u);
            const int x1 = std::min(x0 + 1, image.width - 1);
            for (int c = 0; c < image.channels; ++c) {
                const float top = std::lerp(image.at(x0, y0, c), image.at(x1, y0, c), u - x0);
                const float bottom = std::lerp(image.at(x0, y1, c), image.at(x1, y1, c), u - x0);
                result.at(x, y, c) = std::lerp(top, bottom, v - static_cast<float>(y0));
            }
        }
    }
    return result;
}

}  // namespace item3d
