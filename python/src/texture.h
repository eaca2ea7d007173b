// Texture lookups.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Common parameters of a texture's lookups. A texture of batch size 1 serves all N views.
///
///   texture   [N or 1, H, W, C]; a cube: [N or 1, 6, H, H, C]
///   mips      levels 1, 2, ... in the same form
///   uv        [N, h, w, 2]; for a cube: [N, h, w, 3]
///   slopes    [N, h, w, 4 or 6]: derivatives by x and y of the first coordinate, then of the next
///   bias      [N, h, w], added to the level
///   filter    a kernels::MipmapFilter, or 4 for item3d's anisotropic lookup (kernels/texture.h),
///             which has no gradients with respect to slopes and takes no bias and no cube
///   boundary  a kernels::MipmapBoundary; filter 4 takes `wrap`, `clamp`, or 16 + u + 3 v, where u
///             and v are the kernels::TextureWrap of the two axes
struct Lookup {
    const Tensor& texture;
    const std::vector<Tensor>& mips;
    const Tensor& uv;
    const std::optional<Tensor>& slopes;
    const std::optional<Tensor>& bias;
    std::int64_t filter, boundary;
};

/// Looks up texels and returns them as [N, h, w, C]. Throws std::runtime_error.
Tensor texture(const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
               const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias,
               std::int64_t filter, std::int64_t boundary);

/// Returns four gradients: one flat tensor that concatenates those of all levels, and those with
/// respect to uv, slopes and bias. The first has shape [0] if `texels_wanted` is false. The others
/// have shape [0] if `others_wanted` is false, and those of slopes and bias also where these are
/// not given.
std::tuple<Tensor, Tensor, Tensor, Tensor> texture_backward(
    const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
    const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias, std::int64_t filter,
    std::int64_t boundary, const Tensor& gradient, bool texels_wanted, bool others_wanted);

/// Returns the means of 2 x 2 texels: [B, H, W, C] -> [B, H / 2, W / 2, C]. H and W are even.
Tensor halve(const Tensor& texture);

/// Returns the gradient with respect to halve()'s input: [B, H, W, C] -> [B, 2 H, 2 W, C].
Tensor halve_backward(const Tensor& gradient);

/// Adds halve_backward(gradient) to `finer`, which is contiguous.
void add_halve_backward(const Tensor& gradient, Tensor finer);

}  // namespace item3d::python
