// Patterns of animal coats.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> fur_patterns();

}  // namespace item3d::paint
