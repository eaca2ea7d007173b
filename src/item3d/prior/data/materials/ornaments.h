// Irregular patterns: flowers, camouflage, cracks, flames.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> ornament_patterns();

}  // namespace item3d::paint
