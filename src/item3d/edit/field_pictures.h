// Pictures of the field as it is, for people and captioners.
#pragma once

#include "item3d/edit/scene.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// `count` cameras around the model, a little above it.
std::vector<Camera> field_cameras(const EditScene& scene, int count);

/// [N, size, size, 3] sRGB in [0, 1], a light grey behind. No graph.
at::Tensor draw_field(const EditScene& scene, NeuralTexture& field, const EnvironmentLight& light,
                      const std::vector<Camera>& cameras, int size);

}  // namespace item3d
