// Images in memory.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace item3d {

/// An image. Row 0 is the top; channels are interleaved: pixels[(y * width + x) * channels + c].
/// Values are those of the file. An 8-bit value v becomes v / 255, without a transfer function
/// (sRGB stays encoded). HDR formats are linear and unbounded.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> pixels;

    Image() = default;
    Image(int columns, int rows, int channel_count, float value = 0.0f)
        : width(columns),
          height(rows),
          channels(channel_count),
          pixels(static_cast<std::size_t>(columns) * rows * channel_count, value) {}

    bool empty() const { return pixels.empty(); }
    float& at(int x, int y, int c) {
        return pixels[(static_cast<std::size_t>(y) * width + x) * channels + c];
    }
    float at(int x, int y, int c) const {
        return pixels[(static_cast<std::size_t>(y) * width + x) * channels + c];
    }
};

}  // namespace item3d
