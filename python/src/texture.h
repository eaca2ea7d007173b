// Texture lookups.
#pragma once

#include "python/src/operator.h"

namespace item3d::python {

/// Common parameters of a texture's lookups.
///
/// texture: [N or 1, H, W, C], cubes [N or 1, 6, H, H, C]; mips: levels 1, 2, ... of the same form;
/// uv: [N, h, w, 2], cubes [N, h, w, 3]; slopes: [N, h, w, 4 or 6] by x and y, coordinate after
/// coordinate; bias: [N, h, w]. filter: kernels::MipmapFilter, or 4: item3d's anisotropic lookup
/// (kernels/texture.h; no gradients by slopes, no bias, no cubes, wrap or clamp); boundary:
/// kernels::MipmapBoundary, or for filter 4 also 16 + u + 3 v with kernels::TextureWrap of both
/// axes.
struct Lookup {
    const Tensor& texture;
    const std::vector<Tensor>& mips;
    const Tensor& uv;
    const std::optional<Tensor>& slopes;
    const std::optional<Tensor>& bias;
    std::int64_t filter, boundary;
};

/// Looks texels up, [N, h, w, C]. Throws std::runtime_error.
Tensor texture(const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
               const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias,
               std::int64_t filter, std::int64_t boundary);

/// Returns the gradients of all levels, flat and concatenated, and of uv, slopes and bias; of shape
/// [0] if `texels_wanted` or `others_wanted` is false, and without slopes or bias.
std::tuple<Tensor, Tensor, Tensor, Tensor> texture_backward(
    const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
    const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias, std::int64_t filter,
    std::int64_t boundary, const Tensor& gradient, bool texels_wanted, bool others_wanted);

/// Returns the mean of 2 x 2 texels: [B, H, W, C] -> [B, H / 2, W / 2, C]; H and W even.
Tensor halve(const Tensor& texture);

/// Returns the gradient of halve()'s input: [B, H, W, C] -> [B, 2 H, 2 W, C].
Tensor halve_backward(const Tensor& gradient);

/// Adds halve_backward(gradient) to `finer`, which is contiguous.
void add_halve_backward(const Tensor& gradient, Tensor finer);

}  // namespace item3d::python
