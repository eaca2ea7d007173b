// Vehicle shapes along the x axis, front at +x.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> vehicle_shapes();

}  // namespace item3d
