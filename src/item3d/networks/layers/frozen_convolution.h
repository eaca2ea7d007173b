// 3x3 convolution of stride 1 and padding 1 with frozen weights, packed for a kernel of our own.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace item3d {

/// Base class. For the forward pass, weights are packed once. For the backward pass they are packed
/// on first use, or each time if packing is fast and the packed weights are large.
class FrozenConvolution {
  public:
    /// Function that is called after weights were read. It releases their memory until they are
    /// read again. It may be empty.
    using Forget = std::function<void()>;

    /// Returns the fastest implementation for the map x. Returns null if LibTorch's own must be
    /// used: on devices other than the CPU, on a CPU without the needed instructions, for types
    /// other than float32 and bfloat16, and for numbers of channels that are not multiples of 16
    /// (of 64 for bfloat16). The result convolves maps of all sizes in x's type. x is [N, C, H, W];
    /// weight is [O, C, 3, 3] of float32, bfloat16 or float16.
    static std::shared_ptr<FrozenConvolution> make(const at::Tensor& x, const at::Tensor& weight,
                                                   const Forget& release_pages = {});
    virtual ~FrozenConvolution() = default;

    /// True if `weight` is the tensor that was packed, and was not written to since then.
    bool is_of(const at::Tensor& weight) const;

    /// Releases the original weights if the packed ones suffice for the backward pass, else returns
    /// false.
    bool release_weight();

    /// Convolves x [N, C, H, W] of the type given to make(); bias is [O] or undefined. Returns [N,
    /// O, H, W] in channels-last order.
    at::Tensor forward(const at::Tensor& x, const at::Tensor& bias) const;
    /// Returns the gradient of the input from the gradient of the output.
    at::Tensor backward(const at::Tensor& gradient);

  protected:
    /// Derived classes call pack_forward() in their constructors. dtype: type of the maps, float32
    /// or bfloat16; packed: type of the packed weights. It equals dtype, or is float16 for maps of
    /// float32.
    FrozenConvolution(const at::Tensor& weight, at::ScalarType dtype, at::ScalarType packed,
                      Forget release_pages);
    void pack_forward();

    /// True if a kernel of this project is enabled and can convolve x with this weight: see make().
    static bool fits(const at::Tensor& x, const at::Tensor& weight);

    at::ScalarType dtype() const { return dtype_; }
    at::ScalarType packed_dtype() const { return packed_dtype_; }

  private:
    /// Numbers of channels of the forward convolution, or of the backward one, where they are
    /// swapped.
    struct Channels {
        std::int64_t out, in;
    };

    /// Returns the number of points. A point is one of the packed values for a pair of input and
    /// output channels, which are computed from the nine weights of the 3x3 kernel.
    virtual std::int64_t points() const = 0;
    /// Returns, for each point of the backward pass's packed weights, the point of the forward
    /// pass's packed weights that has the same value; empty if the values differ.
    virtual std::vector<std::int64_t> turned_points() const = 0;
    /// Packs weights [64, 3, 3, in] of packed_dtype() into `packed`. They belong to the 64 output
    /// channels from `column` on (fewer at the end). The layout of `packed` is [points, out / 64,
    /// in / group, 64, group], where group is 2 for bfloat16 and 1 for other types.
    virtual void pack_column(const void* weights, std::int64_t out_channels,
                             std::int64_t in_channels, std::int64_t column, void* packed) const = 0;
    /// x and the result are channels-last; bias is float32 or undefined.
    virtual at::Tensor convolve(const at::Tensor& x, const at::Tensor& packed,
                                std::int64_t out_channels, const at::Tensor& bias) const = 0;

    /// Returns turned_points() if turn_round() applies (for channels in multiples of 64), else an
    /// empty list.
    std::vector<std::int64_t> turned_round() const;
    at::Tensor pack(const at::Tensor& weight) const;
    /// Makes the packed weights of the backward pass from those of the forward pass.
    at::Tensor turn_round(const std::vector<std::int64_t>& points) const;
    at::Tensor packed_for_backward();
    at::Tensor run(const at::Tensor& x, const at::Tensor& packed, std::int64_t out_channels,
                   const at::Tensor& bias) const;

    std::int64_t out_channels_, in_channels_;
    at::ScalarType dtype_, packed_dtype_;
    at::Tensor weight_;  ///< empty once released
    std::uint32_t version_;
    Forget release_pages_;
    at::Tensor packed_;
    std::mutex mutex_;            ///< guards the members below
    at::Tensor packed_backward_;  ///< made by the first backward(), if it is kept
};

}  // namespace item3d
