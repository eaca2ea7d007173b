// Shapes of buildings, plants, clothes and tools.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> thing_shapes();

}  // namespace item3d
