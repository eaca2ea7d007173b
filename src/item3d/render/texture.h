// Textures looked up at surface points.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Bilinear values [P, C] of a texture [H, W, C] at uv [P, 2], where (0, 0) is the top left corner
/// of the image as in glTF; differentiable in the texture and in uv. nearest: the value of the
/// texel that uv lies in.
at::Tensor sample_texture(const at::Tensor& texture, const at::Tensor& uv,
                          Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat,
                          bool nearest = false);

/// A texture and its mip levels, each the mean of two by two texels of the one before, down to one
/// texel; differentiable.
std::vector<at::Tensor> texture_pyramid(const at::Tensor& texture);

/// Anisotropic: up to eight trilinear lookups along the longer axis of each pixel's footprint
/// [P, 4] (Surface::uv_footprint); an undefined footprint takes the first level alone.
/// Differentiable in the levels and in uv. nearest: where a texel is not smaller than a pixel, the
/// texel's own value.
at::Tensor sample_texture(const std::vector<at::Tensor>& levels, const at::Tensor& uv,
                          const at::Tensor& footprint, Wrap wrap_u = Wrap::repeat,
                          Wrap wrap_v = Wrap::repeat, bool nearest = false);

}  // namespace item3d
