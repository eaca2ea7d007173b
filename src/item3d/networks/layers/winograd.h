// Winograd's 3x3 convolution (Lavin & Gray 2016, "Fast Algorithms for Convolutional Neural
// Networks") for inference. It takes half the time of LibTorch's direct convolution in bfloat16
// (AVX-512), and a third to two fifths of that time in float32.
#pragma once

#include "item3d/networks/layers/frozen_convolution.h"

namespace item3d {

/// The results equal those of the direct convolution within float32 rounding. In bfloat16 the error
/// is about twice that of the direct convolution, because the transformed numbers are rounded too.
/// The packed weights of each pass (forward or backward) take 16/9 of the weights' memory in
/// bfloat16, and four times that memory in float32.
class WinogradConvolution : public FrozenConvolution {
  public:
    /// True if this implementation applies and is faster, and x has enough pixels to be worth the
    /// memory.
    static bool gains(const at::Tensor& x, const at::Tensor& weight);

    /// See FrozenConvolution::make().
    WinogradConvolution(const at::Tensor& weight, at::ScalarType dtype, Forget release_pages = {});

  private:
    std::int64_t points() const override;
    std::vector<std::int64_t> turned_points() const override;
    void pack_column(const void* weights, std::int64_t out_channels, std::int64_t in_channels,
                     std::int64_t column, void* packed) const override;
    at::Tensor convolve(const at::Tensor& x, const at::Tensor& packed, std::int64_t out_channels,
                        const at::Tensor& bias) const override;
};

}  // namespace item3d
