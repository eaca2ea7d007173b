// A generated sphere, a model without a file.
#pragma once

#include "item3d/scene/model.h"

namespace item3d {

/// Returns a unit sphere around the origin of latitudes x longitudes quads, with exact normals, UVs
/// that span it once ((0, 0) at the north pole), and one default material.
Model make_unit_sphere(int latitudes, int longitudes);

}  // namespace item3d
