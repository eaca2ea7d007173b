// Plain colours with a finish.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> plain_materials();

}  // namespace item3d::paint
