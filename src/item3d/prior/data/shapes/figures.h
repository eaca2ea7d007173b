// Upright figures, faces at +z.
#pragma once

#include "item3d/prior/data/shapes/makers.h"

#include <vector>

namespace item3d {

std::vector<ShapeMaker> figure_shapes();

}  // namespace item3d
