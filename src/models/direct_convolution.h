// 3x3 convolutions of small maps, for networks that only run: nearly as fast as the processor
// multiplies, where the library's come to a fifth (4 x 4 pixels) or three quarters (8 x 8) of that.
#pragma once

#include "item3d/models/frozen_convolution.h"

namespace item3d {

/// Nine matrix products, one for each of the kernel's places, with weights packed for them: these
/// take no more memory than the weights did.
class DirectConvolution : public FrozenConvolution {
  public:
    /// Whether these can be convolved so. WinogradConvolution is faster for larger maps.
    static bool gains(const torch::Tensor& x, const torch::Tensor& weight);

    /// weight: [O, C, 3, 3].
    explicit DirectConvolution(const torch::Tensor& weight);

  private:
    torch::Tensor pack(const torch::Tensor& weight) const override;
    bool can_turn_round() const override { return true; }
    torch::Tensor turn_round(const torch::Tensor& packed) const override;
    torch::Tensor convolve(const torch::Tensor& x, const torch::Tensor& packed,
                           std::int64_t out_channels, const torch::Tensor& bias) const override;
};

}  // namespace item3d
