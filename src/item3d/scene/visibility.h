// Models of which nothing is seen.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// Whether anything of these materials (indices into Model::materials) can be seen at all: a
/// triangle with an area, whose material, texture and vertex colours are not wholly transparent.
bool is_visible(const Model& model, const std::vector<int>& materials);

/// As above, of all materials.
bool is_visible(const Model& model);

}  // namespace item3d
