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

/// Returns the orientation of the inverse transform.
int inverse_orientation(int orientation);

/// True for the pure rotations 3, 6 and 8, which cameras write. Orientations 2, 4, 5 and 7 mirror
/// the image.
bool is_turn(int orientation);

/// Converts the camera pose of the stored image to the pose of the image that oriented() returns.
/// Camera axes: x right, y up. Accepts orientation 1 and the rotations only.
Mat4 oriented_camera(const Mat4& camera_to_world, int orientation);

}  // namespace item3d
