#include "item3d/field/bake/shrink.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace item3d {
namespace {

Image halve(const Image& image) {
    Image half(std::max(1, image.width / 2), std::max(1, image.height / 2), image.channels);
    const int across = image.width / half.width, down = image.height / half.height;
    const float share = 1.0f / static_cast<float>(across * down);
    for (int y = 0; y < half.height; ++y) {
        for (int x = 0; x < half.width; ++x) {
            for (int c = 0; c < image.channels; ++c) {
                float sum = 0.0f;
                for (int i = 0; i < across * down; ++i)
                    sum += image.at(x * across + i % across, y * down + i / across, c);
                half.at(x, y, c) = share * sum;
            }
        }
    }
    return half;
}

/// The two texels that a lookup at a larger image's texel interpolates along an axis.
struct Mix {
    int first, second;
    float weight;  ///< of the second texel

    Mix(int texel, int texels, int count, Wrap wrap) {
        const float at = (static_cast<float>(texel) + 0.5f) * static_cast<float>(count) /
                             static_cast<float>(texels) -
                         0.5f;
        const int low = static_cast<int>(std::floor(at));
        weight = at - static_cast<float>(low);
        const auto inside = [&](int i) {
            if (wrap == Wrap::repeat) return (i + count) % count;
            return std::clamp(i, 0, count - 1);
        };
        first = inside(low);
        second = inside(low + 1);
    }
};

/// True if lookups in `small` reproduce the texels of `image`.
bool shows(const Image& small, const Image& image, UvWrap wrap, float tolerance) {
    std::vector<double> squares(static_cast<std::size_t>(image.channels), 0.0);
    for (int y = 0; y < image.height; ++y) {
        const Mix down(y, image.height, small.height, wrap.v);
        for (int x = 0; x < image.width; ++x) {
            const Mix across(x, image.width, small.width, wrap.u);
            for (int c = 0; c < image.channels; ++c) {
                const float above =
                    std::lerp(small.at(across.first, down.first, c),
                              small.at(across.second, down.first, c), across.weight);
                const float below =
                    std::lerp(small.at(across.first, down.second, c),
                              small.at(across.second, down.second, c), across.weight);
                const float error = std::lerp(above, below, down.weight) - image.at(x, y, c);
                if (std::abs(error) > 4 * tolerance) return false;
                squares[static_cast<std::size_t>(c)] += static_cast<double>(error) * error;
            }
        }
    }
    const double texels = static_cast<double>(image.width) * image.height;
    return std::all_of(squares.begin(), squares.end(),
                       [&](double sum) { return sum < texels * tolerance * tolerance; });
}

}  // namespace

Image shrink(Image image, UvWrap wrap, float tolerance) {
    const auto halves = [](const Image& of) {
        const auto even = [](int edge) { return edge == 1 || edge % 2 == 0; };
        return (of.width > 1 || of.height > 1) && even(of.width) && even(of.height);
    };
    Image smallest = image;
    while (halves(smallest)) {
        Image half = halve(smallest);
        if (!shows(half, image, wrap, tolerance)) break;
        smallest = std::move(half);
    }
    return smallest;
}

Image halved_to(Image image, const Image& size) {
    while (image.width > size.width || image.height > size.height)
        image = halve(image);
    return image;
}

}  // namespace item3d
