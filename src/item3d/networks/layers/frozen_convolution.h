// A 3x3 convolution of stride 1 and padding 1 whose weights stay as they are, in the order that a
// kernel of our own wants them: for networks that only run.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace item3d {

/// The weights are packed once for the way there; for the way back, when first needed, or each time
/// where that is quick and what it makes is large.
class FrozenConvolution {
  public:
    /// Called after weights were read: lets go of the memory that they take until they are read
    /// again. May be empty.
    using Forget = std::function<void()>;

    /// The kind that is fastest for this map, or none where the library's own is: on another
    /// device or a CPU without the instructions, for other types than float32 and bfloat16, and for
    /// channels that are no multiples of 16 (bfloat16: of 64). What it gives convolves maps of all
    /// sizes in x's type. x: [N, C, H, W], weight: [O, C, 3, 3] of float32, bfloat16 or float16.
    static std::shared_ptr<FrozenConvolution> make(const at::Tensor& x, const at::Tensor& weight,
                                                   const Forget& forget = {});
    virtual ~FrozenConvolution() = default;

    /// False once `weight` is another tensor than the one packed, or was written to.
    bool is_of(const at::Tensor& weight) const;

    /// Lets go of the weights as they were, where the packed ones are enough for the way back too.
    /// False where they are not.
    bool forget_weight();

    /// x [N, C, H, W] of the type that make() saw, bias [O] or none -> [N, O, H, W] in
    /// channels-last order.
    at::Tensor forward(const at::Tensor& x, const at::Tensor& bias) const;
    /// Gradient of the output -> of the input.
    at::Tensor backward(const at::Tensor& gradient);

  protected:
    /// Who derives from this calls pack_forward() in its constructor. dtype: of the maps, float32
    /// or bfloat16; packed: of the packed weights, the same, or float16 for maps of float32.
    FrozenConvolution(const at::Tensor& weight, at::ScalarType dtype, at::ScalarType packed,
                      Forget forget);
    void pack_forward();

    /// Whether a kernel of ours can convolve this and is told to: see make().
    static bool fits(const at::Tensor& x, const at::Tensor& weight);

    at::ScalarType dtype() const { return dtype_; }
    at::ScalarType packed_dtype() const { return packed_dtype_; }

  private:
    /// Channels of a convolution: those of the way there, or swapped.
    struct Channels {
        std::int64_t out, in;
    };

    /// The numbers that packing makes of the nine of a channel pair.
    virtual std::int64_t points() const = 0;
    /// By point of the packed weights of the way back, the one of the way there that it equals;
    /// empty where they differ.
    virtual std::vector<std::int64_t> turned_points() const = 0;
    /// Weights [64, 3, 3, in] of packed_dtype() and of the output channels from `column` on (fewer
    /// in the last column), to their places in `packed`: [points, out / 64, in / group, 64, group],
    /// group of a bfloat16 being 2, of the others 1.
    virtual void pack_column(const void* weights, std::int64_t out_channels,
                             std::int64_t in_channels, std::int64_t column, void* packed) const = 0;
    /// x and the result are channels-last; bias is float32 or undefined.
    virtual at::Tensor convolve(const at::Tensor& x, const at::Tensor& packed,
                                std::int64_t out_channels, const at::Tensor& bias) const = 0;

    /// turned_points() where turn_round() can be used: columns that are all whole.
    std::vector<std::int64_t> turned_round() const;
    at::Tensor pack(const at::Tensor& weight) const;
    /// The packed weights of the way back from those of the way there.
    at::Tensor turn_round(const std::vector<std::int64_t>& points) const;
    at::Tensor packed_for_backward();
    at::Tensor run(const at::Tensor& x, const at::Tensor& packed, std::int64_t out_channels,
                   const at::Tensor& bias) const;

    std::int64_t out_channels_, in_channels_;
    at::ScalarType dtype_, packed_dtype_;
    at::Tensor weight_;  ///< empty once forgotten
    std::uint32_t version_;
    Forget forget_;
    at::Tensor packed_;
    std::mutex mutex_;            ///< of what follows
    at::Tensor packed_backward_;  ///< made by the first backward(), where it is kept
};

}  // namespace item3d
