// Downscaled images for the page.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// Halves the image, each pixel the mean of four, until it is at most `width` wide. An odd last row
/// or column is dropped.
Image halved(Image image, int width);

/// Crops the image's left square, the first of views side by side, and halves it until it is at
/// most `width` wide.
Image first_view(const Image& views, int width);

}  // namespace item3d
