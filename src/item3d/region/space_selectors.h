// Selectors by place.
#pragma once

#include "item3d/region/selector.h"

namespace item3d {

/// Coordinates as the file has them (Model::origin included). Throws InputError for what is not
/// "X0,Y0,Z0,X1,Y1,Z1" or "X,Y,Z,R", or lies outside the model.
std::unique_ptr<Selector> select_box(const SelectorText& text, const RegionScene& scene);
std::unique_ptr<Selector> select_sphere(const SelectorText& text, const RegionScene& scene);

}  // namespace item3d
