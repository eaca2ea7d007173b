// Texture lookups at surface points.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Returns bilinear values [P, C] of a texture [H, W, C] at uv [P, 2], where (0, 0) is the top left
/// corner of the image as in glTF. Differentiable in the texture and in uv. nearest: true if the
/// value is that of the texel that contains uv.
at::Tensor sample_texture(const at::Tensor& texture, const at::Tensor& uv,
                          Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat,
                          bool nearest = false);

/// Returns a texture and its mip levels down to one texel. A texel of a level is the mean of two by
/// two texels of the previous level. Differentiable.
std::vector<at::Tensor> texture_pyramid(const at::Tensor& texture);

/// Returns values of an anisotropic lookup, with up to eight trilinear probes along the longer axis
/// of each pixel's footprint [P, 4] (Surface::uv_footprint). With an undefined footprint, only the
/// first level is used. Differentiable in the levels and in uv. nearest: true if a texel is not
/// filtered where it is at least as large as a pixel.
at::Tensor sample_texture(const std::vector<at::Tensor>& levels, const at::Tensor& uv,
                          const at::Tensor& footprint, Wrap wrap_u = Wrap::repeat,
                          Wrap wrap_v = Wrap::repeat, bool nearest = false);

}  // namespace item3d
