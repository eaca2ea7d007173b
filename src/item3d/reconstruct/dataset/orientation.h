// Image orientations of EXIF.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

// EXIF's orientations, 1 to 8, are the transforms from the stored to the shown image.

/// True if showing the image swaps width and height.
bool swaps_sides(int orientation);

/// Returns the image the right way up.
Image oriented(const Image& stored, int orientation);

/// Returns the inverse orientation.
int inverse_orientation(int orientation);

/// True for pure rotations, 3, 6 and 8, which cameras write; the others mirror.
bool is_turn(int orientation);

/// Returns the camera pose of oriented()'s image from that of the stored one. Camera axes: x right,
/// y up. For orientation 1 and rotations only.
Mat4 oriented_camera(const Mat4& camera_to_world, int orientation);

}  // namespace item3d
