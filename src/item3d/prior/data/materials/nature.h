// Natural coverings (moss, snow, ...) and elements.
#pragma once

#include "item3d/prior/data/materials/makers.h"

#include <vector>

namespace item3d::paint {

std::vector<MaterialKind> nature_materials();

}  // namespace item3d::paint
