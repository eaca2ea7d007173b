// Which way up a camera was held.
#pragma once

#include "item3d/core/files.h"
#include "item3d/scene/image.h"

namespace item3d {

/// EXIF orientation of a JPEG, 1 to 8; 1 (as stored) where it says nothing.
int exif_orientation(const Bytes& file);

/// Whether showing the picture swaps its sides.
bool swaps_sides(int orientation);

/// The picture the right way up.
Image oriented(const Image& stored, int orientation);

}  // namespace item3d
