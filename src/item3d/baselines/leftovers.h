// The filling of texels that no view painted.
#pragma once

#include "item3d/baselines/texel_list.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Sets unknown colors to the mean of known ones (TEXTure); unchanged if none is known. colors: [T,
/// 3]; known: [T] bool.
at::Tensor fill_with_mean(const at::Tensor& colors, const at::Tensor& known);

/// Sets unknown texels to the mean of their known neighbours in the texture, layer by layer
/// outwards; islands without known texels get the mean of all known ones.
at::Tensor fill_from_neighbours(const TexelList& texels, const at::Tensor& colors,
                                const at::Tensor& known);

}  // namespace item3d
