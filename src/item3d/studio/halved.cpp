#include "item3d/studio/halved.h"

#include <algorithm>

namespace item3d {

Image halved(Image image, int width) {
    while (image.width > width && image.width > 1 && image.height > 1) {
        Image half(image.width / 2, image.height / 2, image.channels);
        for (int y = 0; y < half.height; ++y)
            for (int x = 0; x < half.width; ++x)
                for (int c = 0; c < half.channels; ++c)
                    half.at(x, y, c) =
                        0.25f * (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) +
                                 image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c));
        image = std::move(half);
    }
    return image;
}

Image first_view(const Image& views, int width) {
    const int side = std::min(views.width, views.height);
    Image view(side, side, views.channels);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < views.channels; ++c)
                view.at(x, y, c) = views.at(x, y, c);
    return halved(std::move(view), width);
}

}  // namespace item3d
