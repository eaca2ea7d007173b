// Pictures made small for the page.
#pragma once

#include "item3d/scene/image.h"

namespace item3d {

/// The picture halved, each pixel the mean of four, until it is no wider than `width`. An odd last
/// row or column is left out.
Image halved(Image image, int width);

/// The picture's left square, halved until it is no wider than `width`: the first of views that lie
/// side by side.
Image first_view(const Image& views, int width);

}  // namespace item3d
