// A generated sphere, a model without a file.
#pragma once

#include "item3d/scene/model.h"

namespace item3d {

/// Returns a unit sphere around the origin that consists of latitudes x longitudes quads. Its
/// normals are exact, its UVs cover [0, 1] x [0, 1] once with v = 0 at the north pole, and it has
/// one default material.
Model make_unit_sphere(int latitudes, int longitudes);

}  // namespace item3d
