// Shapes of vessels and containers.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> vessel_shapes();

}  // namespace item3d
