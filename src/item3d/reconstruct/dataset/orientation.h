// Which way up a camera was held.
#pragma once

#include "item3d/core/math.h"
#include "item3d/scene/image.h"

namespace item3d {

// EXIF's orientations are 1 to 8: what is done to a stored picture to show it.

/// Whether showing the picture swaps its sides.
bool swaps_sides(int orientation);

/// The picture the right way up.
Image oriented(const Image& stored, int orientation);

/// What undoes it.
int inverse_orientation(int orientation);

/// 3, 6 and 8 turn, without a mirror: what a camera does by itself.
bool is_turn(int orientation);

/// The pose of a camera that stored a picture, as of one that was held so that it stores what
/// oriented() shows. Camera axes: x right, y up. Only for orientations that turn, and 1.
Mat4 oriented_camera(const Mat4& camera_to_world, int orientation);

}  // namespace item3d
