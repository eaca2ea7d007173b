#include "item3d/report/display_image.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {

namespace {

float encode(float linear) {
    return linear_to_srgb(std::clamp(linear, 0.0f, 1.0f));
}

/// Weights of the input pixels for one output pixel. When shrinking, a weight is the overlap with
/// the output pixel's box. When enlarging, it is a tent function of the distance.
struct Taps {
    int first = 0;
    std::vector<float> weights;
};

std::vector<Taps> resampling(int from, int to) {
    const double scale = static_cast<double>(from) / to;
    const double radius = std::max(scale, 1.0);
    std::vector<Taps> all(to);
    for (int i = 0; i < to; ++i) {
        const double centre = (i + 0.5) * scale - 0.5;
        Taps& taps = all[i];
        taps.first = std::clamp(static_cast<int>(std::ceil(centre - radius)), 0, from - 1);
        const int last =
            std::clamp(static_cast<int>(std::floor(centre + radius)), taps.first, from - 1);
        double sum = 0;
        for (int j = taps.first; j <= last; ++j) {
            double weight = 0;
            if (scale > 1) {
                const double low = std::max(j - 0.5, centre - 0.5 * scale);
                const double high = std::min(j + 0.5, centre + 0.5 * scale);
                weight = std::max(0.0, high - low);
            } else {
                weight = std::max(0.0, 1 - std::abs(j - centre));
            }
            taps.weights.push_back(static_cast<float>(weight));
            sum += weight;
        }
        for (float& weight : taps.weights)
            weight /= static_cast<float>(sum);
    }
    return all;
}

}  // namespace

Image to_display(const Image& linear, std::optional<Vec3> background) {
    ITEM3D_CHECK(linear.channels == 3 || linear.channels == 4, "radiance is RGB or RGBA");
    const bool transparent = linear.channels == 4 && !background;
    Image image(linear.width, linear.height, transparent ? 4 : 3);
    parallel_for(
        "to_display", static_cast<std::int64_t>(linear.width) * linear.height, [&](std::int64_t i) {
            const float* from = &linear.pixels[i * linear.channels];
            float* to = &image.pixels[i * image.channels];
            const float alpha = linear.channels == 4 ? std::clamp(from[3], 0.0f, 1.0f) : 1;
            for (int c = 0; c < 3; ++c) {
                if (transparent) {
                    to[c] = alpha > 0 ? encode(from[c] / alpha) : 0.0f;
                } else {
                    to[c] = encode(from[c] + (background ? (1 - alpha) * (*background)[c] : 0));
                }
            }
            if (transparent) to[3] = alpha;
        });
    return image;
}

Image flatten(const Image& image, Vec3 background) {
    Image flat(image.width, image.height, 3);
    const Vec3 behind(srgb_to_linear(background.x), srgb_to_linear(background.y),
                      srgb_to_linear(background.z));
    const bool has_alpha = image.channels == 2 || image.channels == 4;
    parallel_for(
        "flatten", static_cast<std::int64_t>(image.width) * image.height, [&](std::int64_t i) {
            const float* from = &image.pixels[i * image.channels];
            float* to = &flat.pixels[i * 3];
            const float alpha = has_alpha ? from[image.channels - 1] : 1;
            for (int c = 0; c < 3; ++c) {
                const float value = from[image.channels >= 3 ? c : 0];
                to[c] = alpha == 1
                            ? value
                            : encode(alpha * srgb_to_linear(value) + (1 - alpha) * behind[c]);
            }
        });
    return flat;
}

Image resize(const Image& image, int width, int height) {
    ITEM3D_CHECK(width > 0 && height > 0 && !image.empty(), "an image needs pixels");
    if (width == image.width && height == image.height) return image;
    const int channels = image.channels;
    const std::vector<Taps> columns = resampling(image.width, width);
    Image narrow(width, image.height, channels);
    parallel_for(
        "resize columns", image.height,
        [&](std::int64_t y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < channels; ++c) {
                    float sum = 0;
                    for (std::size_t k = 0; k < columns[x].weights.size(); ++k) {
                        sum +=
                            columns[x].weights[k] * image.at(columns[x].first + static_cast<int>(k),
                                                             static_cast<int>(y), c);
                    }
                    narrow.at(x, static_cast<int>(y), c) = sum;
                }
            }
        },
        8);
    const std::vector<Taps> rows = resampling(image.height, height);
    Image result(width, height, channels);
    parallel_for(
        "resize rows", height,
        [&](std::int64_t y) {
            float* to = &result.pixels[y * width * channels];
            for (std::size_t k = 0; k < rows[y].weights.size(); ++k) {
                const auto source = static_cast<std::size_t>(rows[y].first) + k;
                const float* from = &narrow.pixels[source * width * channels];
                for (int i = 0; i < width * channels; ++i)
                    to[i] += rows[y].weights[k] * from[i];
            }
        },
        8);
    return result;
}

Image thumbnail(const Image& image, int longest) {
    const int side = std::max(image.width, image.height);
    if (side <= longest) return image;
    const double scale = static_cast<double>(longest) / side;
    return resize(image, std::max(1, static_cast<int>(std::lround(image.width * scale))),
                  std::max(1, static_cast<int>(std::lround(image.height * scale))));
}

}  // namespace item3d
