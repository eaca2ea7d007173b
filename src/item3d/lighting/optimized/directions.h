// The directions that a light's texels look in.
#pragma once

#include <torch/types.h>

namespace item3d {

/// [6, size, size, 3] unit vectors through the texels of a cube, faces as of EnvironmentLight.
torch::Tensor cube_directions(int size);

/// [height, 2 height, 3], those of an equirectangular map (scene/environment.h).
torch::Tensor map_directions(int height);

}  // namespace item3d
