// 3x3 convolution of small maps for inference. Its speed is close to the processor's peak.
// LibTorch's convolution reaches a fifth (4 x 4 pixels) or three quarters (8 x 8) of that speed.
#pragma once

#include "item3d/networks/layers/frozen_convolution.h"

namespace item3d {

/// Nine matrix products, one for each kernel position, with packed weights that take no more memory
/// than the original ones.
class DirectConvolution : public FrozenConvolution {
  public:
    /// True if this implementation applies. WinogradConvolution is faster for larger maps.
    static bool gains(const at::Tensor& x, const at::Tensor& weight);

    /// See FrozenConvolution::make().
    DirectConvolution(const at::Tensor& weight, at::ScalarType dtype, Forget release_pages = {});

  private:
    std::int64_t points() const override { return 9; }
    std::vector<std::int64_t> turned_points() const override;
    void pack_column(const void* weights, std::int64_t out_channels, std::int64_t in_channels,
                     std::int64_t column, void* packed) const override;
    at::Tensor convolve(const at::Tensor& x, const at::Tensor& packed, std::int64_t out_channels,
                        const at::Tensor& bias) const override;
};

}  // namespace item3d
