// The directions of a light's texels.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns [6, size, size, 3] unit vectors through the texels of a cube with the faces of
/// EnvironmentLight.
at::Tensor cube_directions(int size);

/// Returns [height, 2 height, 3] unit vectors through the texels of an equirectangular map
/// (lighting/environment.h).
at::Tensor map_directions(int height);

}  // namespace item3d
