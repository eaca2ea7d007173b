// Materials of crafted things: ceramics, glass-like materials, leather.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> craft_materials();

}  // namespace item3d::paint
