// Texels that no view painted.
#pragma once

#include "item3d/baselines/texel_list.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// colors [T, 3]; known [T] bool. The others become the mean of the known ones (TEXTure). Without
/// known ones they stay.
at::Tensor fill_with_mean(const at::Tensor& colors, const at::Tensor& known);

/// The others become the mean of their neighbours in the texture that have a value already, layer
/// by layer from the known ones; islands without any become the mean of all known ones.
at::Tensor fill_from_neighbours(const TexelList& texels, const at::Tensor& colors,
                                const at::Tensor& known);

}  // namespace item3d
