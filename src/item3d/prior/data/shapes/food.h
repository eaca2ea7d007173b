// Shapes of fruit, vegetables and cakes.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> food_shapes();

}  // namespace item3d
