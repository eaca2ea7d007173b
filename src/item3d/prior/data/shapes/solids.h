// Abstract solids and random shapes.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> solid_shapes();

}  // namespace item3d
