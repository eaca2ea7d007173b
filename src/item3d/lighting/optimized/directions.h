// The directions that a light's texels look in.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// [6, size, size, 3] unit vectors through the texels of a cube, faces as of EnvironmentLight.
at::Tensor cube_directions(int size);

/// [height, 2 height, 3], those of an equirectangular map (lighting/environment.h).
at::Tensor map_directions(int height);

}  // namespace item3d
