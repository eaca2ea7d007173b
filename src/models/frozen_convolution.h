// A 3x3 convolution of stride 1 and padding 1 whose weights stay as they are, in the order that a
// kernel of our own wants them: for networks that only run.
#pragma once

#include <torch/types.h>

#include <cstdint>
#include <memory>

namespace item3d {

/// The weights are packed once for the way there and, when first needed, once for the way back.
class FrozenConvolution {
  public:
    /// The kind that is fastest for this map, or none where the library's own is: on another
    /// device or a CPU without the instructions, for other types than float32 and bfloat16, and for
    /// channels that are no multiples of 64. What it gives convolves maps of all sizes.
    /// x: [N, C, H, W], weight: [O, C, 3, 3].
    static std::shared_ptr<FrozenConvolution> make(const torch::Tensor& x,
                                                   const torch::Tensor& weight);
    virtual ~FrozenConvolution() = default;

    /// False once `weight` is another tensor than the one packed, or was written to.
    bool is_of(const torch::Tensor& weight) const;

    /// Lets go of the weights as they were, where the packed ones are enough for the way back too.
    /// False where they are not.
    bool forget_weight();

    /// x [N, C, H, W] of the weights' type, bias [O] or none -> [N, O, H, W] in channels-last
    /// order.
    torch::Tensor forward(const torch::Tensor& x, const torch::Tensor& bias) const;
    /// Gradient of the output -> of the input.
    torch::Tensor backward(const torch::Tensor& gradient);

  protected:
    /// `packed`: of `weight`, as pack() has it.
    FrozenConvolution(const torch::Tensor& weight, torch::Tensor packed);

    /// Whether a kernel of ours can convolve this and is told to: see make().
    static bool fits(const torch::Tensor& x, const torch::Tensor& weight);

    std::int64_t out_channels() const { return out_channels_; }
    std::int64_t in_channels() const { return in_channels_; }
    torch::Dtype dtype() const { return dtype_; }

  private:
    /// weight [O, C, 3, 3] as convolve() wants it.
    virtual torch::Tensor pack(const torch::Tensor& weight) const = 0;
    /// Whether turn_round() can do what it says.
    virtual bool can_turn_round() const = 0;
    /// The packed weights of the way back from those of the way there.
    virtual torch::Tensor turn_round(const torch::Tensor& packed) const = 0;
    /// x and the result are channels-last; bias is float32 or undefined.
    virtual torch::Tensor convolve(const torch::Tensor& x, const torch::Tensor& packed,
                                   std::int64_t out_channels, const torch::Tensor& bias) const = 0;

    torch::Tensor run(const torch::Tensor& x, const torch::Tensor& packed,
                      std::int64_t out_channels, const torch::Tensor& bias) const;

    std::int64_t out_channels_, in_channels_;
    torch::Dtype dtype_;
    torch::Tensor weight_;  ///< empty once forgotten
    std::uint32_t version_;
    torch::Tensor packed_;
    torch::Tensor packed_backward_;  ///< made by the first backward()
};

}  // namespace item3d
