// Animal shapes, heads at +x.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> animal_shapes();

}  // namespace item3d
