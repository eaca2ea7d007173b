// Selectors by location.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// These functions select by a box or a sphere. Coordinates are those of the file (Model::origin
/// included). Throws InputError for values other than "X0,Y0,Z0,X1,Y1,Z1" or "X,Y,Z,R", and for
/// volumes outside the model.
std::unique_ptr<Selector> select_box(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_sphere(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
