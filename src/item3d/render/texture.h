// Texture lookups at surface points.
#pragma once

#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Returns bilinear values [P, C] of a texture [H, W, C] at uv [P, 2], where (0, 0) is the top left
/// corner of the image as in glTF; differentiable in the texture and in uv. nearest: the value of
/// the texel that contains uv.
at::Tensor sample_texture(const at::Tensor& texture, const at::Tensor& uv,
                          Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat,
                          bool nearest = false);

/// Returns a texture and its mip levels, each the mean of two by two texels of the previous one,
/// down to one texel; differentiable.
std::vector<at::Tensor> texture_pyramid(const at::Tensor& texture);

/// Anisotropic lookup: up to eight trilinear probes along the longer axis of each pixel's footprint
/// [P, 4] (Surface::uv_footprint); an undefined footprint uses the first level only. Differentiable
/// in the levels and in uv. nearest: the unfiltered texel where it is at least as large as a pixel.
at::Tensor sample_texture(const std::vector<at::Tensor>& levels, const at::Tensor& uv,
                          const at::Tensor& footprint, Wrap wrap_u = Wrap::repeat,
                          Wrap wrap_v = Wrap::repeat, bool nearest = false);

}  // namespace item3d
