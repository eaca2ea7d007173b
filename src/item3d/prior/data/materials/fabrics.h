// Fabrics, most of them dyed in a plain colour.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> fabric_materials();

}  // namespace item3d::paint
