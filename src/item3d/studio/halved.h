// Downscaled images for the page.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// Halves the image until it is at most `width` wide. A pixel becomes the mean of four. An odd last
/// row or column is dropped.
Image halved(Image image, int width);

/// Returns the first of square views that are side by side in an image, halved until it is at most
/// `width` wide.
Image first_view(const Image& views, int width);

}  // namespace item3d
