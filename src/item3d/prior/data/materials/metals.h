// Metals by name and finish.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> metal_materials();

}  // namespace item3d::paint
