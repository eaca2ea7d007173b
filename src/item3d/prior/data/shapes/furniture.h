// Shapes of furniture.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> furniture_shapes();

}  // namespace item3d
