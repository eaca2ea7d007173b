// Woods: annual rings of a trunk, cut into boards.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> wood_materials();

}  // namespace item3d::paint
