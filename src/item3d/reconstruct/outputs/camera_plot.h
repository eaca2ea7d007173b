// Plot of the camera positions.
#pragma once

#include "item3d/reconstruct/dataset/dataset.h"

#include <array>
#include <string>

namespace item3d {

/// Returns inline SVG that shows the cameras and the model's box from above and from the front.
/// Cameras of held-out views are rings.
std::string camera_plot(const Dataset& dataset, std::array<Vec3, 2> bounds);

}  // namespace item3d
