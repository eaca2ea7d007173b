#include "item3d/models/winograd.h"

#include "item3d/core/error.h"
#include "item3d/models/winograd_kernel.h"

#include <ATen/Parallel.h>

#include <algorithm>

namespace item3d {
namespace {

using std::int64_t;

int64_t round_up(int64_t value, int64_t step) {
    return (value + step - 1) / step * step;
}

bool is_bfloat16(const torch::Tensor& tensor) {
    return tensor.scalar_type() == torch::kBFloat16;
}

template <typename Number>
Number* numbers(const torch::Tensor& tensor) {
    return static_cast<Number*>(tensor.data_ptr());
}

template <typename Number>
torch::Tensor pack(const torch::Tensor& weight) {
    const int64_t out = weight.size(0), in = weight.size(1);
    const torch::Tensor ordered = weight.contiguous(torch::MemoryFormat::ChannelsLast);
    const torch::Tensor packed =
        torch::empty({winograd_points<Number> * out * in}, weight.options());
    at::parallel_for(0, out / winograd_columns, 1, [&](int64_t first, int64_t last) {
        pack_winograd_weights(numbers<const Number>(ordered), out, in, first * winograd_columns,
                              last * winograd_columns, numbers<Number>(packed));
    });
    return packed;
}

torch::Tensor pack(const torch::Tensor& weight) {
    return is_bfloat16(weight) ? pack<BrainFloat>(weight) : pack<float>(weight);
}

/// The packed weights of the way back from those of the way there, for tiles of 2 x 2: their points
/// are 0, 1, -1 and infinity, and turning a kernel round swaps the first and the last.
torch::Tensor turn_round(const torch::Tensor& packed, int64_t out, int64_t in) {
    const torch::Tensor swapped = torch::tensor({3, 1, 2, 0}, torch::kInt64);
    return packed.view({4, 4, out / winograd_columns, in / 2, winograd_columns, 2})
        .index_select(0, swapped)
        .index_select(1, swapped)
        .permute({0, 1, 3, 5, 2, 4})  // [4, 4, in / 2, 2, out / columns, columns]
        .reshape({16, in / winograd_columns, winograd_columns, out / 2, 2})
        .permute({0, 1, 3, 2, 4})
        .reshape({-1})
        .contiguous();
}

/// How the work is cut: every task has its tiles, and of those some output channels.
struct Division {
    int64_t tiles;     ///< of a task
    int64_t channels;  ///< of a task
    int64_t tile_ranges, channel_ranges;
};

/// As many tiles a task as keep its scratch memory within a core's cache, and enough tasks for all
/// threads.
template <typename Number>
Division divide(const WinogradShape& shape) {
    constexpr int64_t cache = 1200 << 10;  // measured best with 1 MB of second-level cache
    // Fewer would read the weights from the memory too often.
    constexpr int64_t fewest = 48;
    const int64_t threads = at::get_num_threads(), tiles = shape.tiles(winograd_tile<Number>);
    const int64_t bytes_a_tile = winograd_scratch<Number>(fewest, shape.in_channels) / fewest;
    const int64_t fitting = std::max(fewest, cache / bytes_a_tile);
    int64_t ranges = (tiles + fitting - 1) / fitting, groups = 1;
    if (ranges < threads)
        groups = (threads + ranges - 1) / ranges;
    else
        ranges = round_up(ranges, threads);
    const int64_t columns = shape.out_channels / winograd_columns;
    const int64_t columns_a_task = (columns + groups - 1) / groups;
    Division result;
    result.tiles = (tiles + ranges - 1) / ranges;
    result.channels = columns_a_task * winograd_columns;
    result.tile_ranges = (tiles + result.tiles - 1) / result.tiles;
    result.channel_ranges = (columns + columns_a_task - 1) / columns_a_task;
    return result;
}

template <typename Number>
void convolve(const WinogradShape& shape, const Number* x, const Number* packed, const float* bias,
              Number* y) {
    const Division division = divide<Number>(shape);
    const int64_t tiles = shape.tiles(winograd_tile<Number>);
    const int64_t scratch_bytes = winograd_scratch<Number>(division.tiles, shape.in_channels);
    at::parallel_for(
        0, division.tile_ranges * division.channel_ranges, 1, [&](int64_t first, int64_t last) {
            const torch::Tensor scratch = torch::empty({scratch_bytes}, torch::kUInt8);
            for (int64_t task = first; task < last; ++task) {
                WinogradPart part;
                part.first_tile = task / division.channel_ranges * division.tiles;
                part.last_tile = std::min(tiles, part.first_tile + division.tiles);
                part.first_channel = task % division.channel_ranges * division.channels;
                part.last_channel =
                    std::min(shape.out_channels, part.first_channel + division.channels);
                convolve_winograd(shape, x, packed, bias, y, part, scratch.data_ptr());
            }
        });
}

torch::Tensor convolve(const torch::Tensor& input, const torch::Tensor& packed,
                       int64_t out_channels, const torch::Tensor& bias) {
    const torch::Tensor x = input.contiguous(torch::MemoryFormat::ChannelsLast);
    const WinogradShape shape{x.size(0), x.size(2), x.size(3), x.size(1), out_channels};
    const torch::Tensor y =
        torch::empty({shape.pictures, out_channels, shape.height, shape.width},
                     x.options().memory_format(torch::MemoryFormat::ChannelsLast));
    torch::Tensor float_bias;
    if (bias.defined()) float_bias = bias.to(torch::kFloat32).contiguous();
    const float* added = bias.defined() ? float_bias.data_ptr<float>() : nullptr;
    if (is_bfloat16(x))
        convolve(shape, numbers<const BrainFloat>(x), numbers<const BrainFloat>(packed), added,
                 numbers<BrainFloat>(y));
    else
        convolve(shape, numbers<const float>(x), numbers<const float>(packed), added,
                 numbers<float>(y));
    return y;
}

bool kernel_runs(torch::Dtype dtype) {
    static const bool float_runs = winograd_kernel_runs<float>();
    static const bool bfloat_runs = winograd_kernel_runs<BrainFloat>();
    return (dtype == torch::kFloat32 && float_runs) || (dtype == torch::kBFloat16 && bfloat_runs);
}

}  // namespace

bool WinogradConvolution::gains(const torch::Tensor& x, const torch::Tensor& weight) {
    constexpr int64_t fewest_pixels = 512;
    return x.is_cpu() && x.scalar_type() == weight.scalar_type() && kernel_runs(x.scalar_type()) &&
           weight.size(0) % winograd_columns == 0 && weight.size(1) % winograd_columns == 0 &&
           x.size(0) * x.size(2) * x.size(3) >= fewest_pixels;
}

WinogradConvolution::WinogradConvolution(const torch::Tensor& weight)
    : out_channels_(weight.size(0)),
      in_channels_(weight.size(1)),
      dtype_(weight.scalar_type()),
      weight_(weight.detach()),
      version_(static_cast<std::uint32_t>(weight._version())),
      packed_(pack(weight_)) {}

bool WinogradConvolution::is_of(const torch::Tensor& weight) const {
    return weight_.defined() && weight.data_ptr() == weight_.data_ptr() &&
           weight.strides() == weight_.strides() &&
           static_cast<std::uint32_t>(weight_._version()) == version_;
}

bool WinogradConvolution::forget_weight() {
    if (dtype_ != torch::kBFloat16) return false;
    weight_ = torch::Tensor();
    return true;
}

torch::Tensor WinogradConvolution::forward(const torch::Tensor& x,
                                           const torch::Tensor& bias) const {
    ITEM3D_CHECK(x.dim() == 4 && x.size(1) == in_channels_ && x.scalar_type() == dtype_,
                 "x must be [N, C, H, W] with the weights' channels and type");
    return convolve(x, packed_, out_channels_, bias);
}

torch::Tensor WinogradConvolution::backward(const torch::Tensor& gradient) {
    // The way back is the convolution with the weights turned round and their channels swapped.
    if (!packed_backward_.defined())
        packed_backward_ = dtype_ == torch::kBFloat16
                               ? turn_round(packed_, out_channels_, in_channels_)
                               : pack(weight_.flip({2, 3}).transpose(0, 1));
    return convolve(gradient.to(dtype_), packed_backward_, in_channels_, {});
}

}  // namespace item3d
