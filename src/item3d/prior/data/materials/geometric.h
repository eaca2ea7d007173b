// Two-coloured geometric patterns. They are the hardest for the prior, so cells are large and edges
// soft enough to survive at 64 pixels.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> geometric_patterns();

}  // namespace item3d::paint
