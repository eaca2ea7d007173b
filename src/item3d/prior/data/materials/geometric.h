// Two-coloured geometric patterns. They are the hardest materials for the prior. Their cells are
// therefore large, and their edges are soft enough to survive in an image of 64 pixels.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> geometric_patterns();

}  // namespace item3d::paint
