// 3x3 convolutions with fewer multiplications (Lavin & Gray 2016, "Fast Algorithms for
// Convolutional Neural Networks"), for networks that only run: on a CPU with AVX-512 they take half
// the time of the library's direct ones in bfloat16 and a third in float32.
#pragma once

#include <torch/types.h>

#include <cstdint>

namespace item3d {

/// A convolution of stride 1 and padding 1 whose weights stay as they are. They are transformed
/// once for the way there and, when first needed, once for the way back; the two take 16/9 of the
/// weights' memory each in bfloat16, four times in float32.
class WinogradConvolution {
  public:
    /// Whether these can be convolved so, and faster: a CPU that has the instructions (none that
    /// multiplies bfloat16 in matrix units), float32 or bfloat16, channels in multiples of 64, and
    /// enough pixels to be worth the memory of the transformed weights.
    static bool gains(const torch::Tensor& x, const torch::Tensor& weight);

    /// weight: [O, C, 3, 3].
    explicit WinogradConvolution(const torch::Tensor& weight);

    /// False once `weight` is another tensor than the one transformed, or was written to.
    bool is_of(const torch::Tensor& weight) const;

    /// Lets go of the weights as they were, where the transformed ones are enough for the way back
    /// too (bfloat16's are). False where they are not.
    bool forget_weight();

    /// x [N, C, H, W] of the weights' type, bias [O] or none -> [N, O, H, W] in channels-last
    /// order. Within float32's rounding errors of the direct convolution; bfloat16's error is about
    /// twice the direct one's, for the transformed numbers are rounded too.
    torch::Tensor forward(const torch::Tensor& x, const torch::Tensor& bias) const;
    /// Gradient of the output -> of the input.
    torch::Tensor backward(const torch::Tensor& gradient);

  private:
    std::int64_t out_channels_, in_channels_;
    torch::Dtype dtype_;
    torch::Tensor weight_;  ///< empty once forgotten
    std::uint32_t version_;
    torch::Tensor packed_;
    torch::Tensor packed_backward_;  ///< made by the first backward()
};

}  // namespace item3d
