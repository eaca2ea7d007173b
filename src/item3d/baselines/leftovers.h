// The filling of texels that no view painted.
#pragma once

#include "item3d/baselines/texel_list.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Sets unknown colours to the mean of the known ones, as TEXTure does. Changes nothing if no
/// colour is known. colors: [T, 3]; known: [T] bool.
at::Tensor fill_with_mean(const at::Tensor& colors, const at::Tensor& known);

/// Sets unknown texels to colours interpolated from the known ones near them in the texture
/// (TexelList::spread()). Textures without known texels get the mean of all known ones. Changes
/// nothing if no texel is known.
at::Tensor fill_from_neighbours(const TexelList& texels, const at::Tensor& colors,
                                const at::Tensor& known);

}  // namespace item3d
