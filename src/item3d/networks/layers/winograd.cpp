#include "item3d/networks/layers/winograd.h"

#include "item3d/kernels/cpu/conv/winograd_kernel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <algorithm>

namespace item3d {
namespace {

using std::int64_t;

int64_t round_up(int64_t value, int64_t step) {
    return (value + step - 1) / step * step;
}

bool is_bfloat16(const at::Tensor& tensor) {
    return tensor.scalar_type() == at::kBFloat16;
}

template <typename Number>
Number* numbers(const at::Tensor& tensor) {
    return static_cast<Number*>(tensor.data_ptr());
}

template <typename Number>
const auto& best_winograd_kernel() {
    return kernel_for_this_processor<Number>(
        []<InstructionSet instructions> { return winograd_kernel<instructions, Number>(); });
}

/// Partition of the work. Every task computes some output channels of some tiles.
struct Division {
    int64_t tiles;     ///< per task
    int64_t channels;  ///< per task
    int64_t tile_ranges, channel_ranges;
};

/// Returns the largest number of tiles per task whose scratch memory fits into a core's cache, with
/// enough tasks for all threads.
template <typename Number>
Division divide(const ConvolutionShape& shape) {
    constexpr int64_t cache = 2000 << 10;  // bytes; measured best with 1 MB of second-level cache
    // The weights would be read from memory too often with fewer tiles.
    constexpr int64_t fewest = 96;
    const int64_t threads = at::get_num_threads(), tiles = shape.tiles(winograd_tile<Number>);
    const int64_t bytes_a_tile =
        best_winograd_kernel<Number>()->scratch(fewest, shape.in_channels) / fewest;
    const int64_t fitting = std::max(fewest, cache / bytes_a_tile);
    int64_t ranges = (tiles + fitting - 1) / fitting, groups = 1;
    if (ranges < threads)
        groups = (threads + ranges - 1) / ranges;
    else
        ranges = round_up(ranges, threads);
    const int64_t columns = columns_of(shape.out_channels);
    const int64_t columns_a_task = (columns + groups - 1) / groups;
    Division result;
    result.tiles = (tiles + ranges - 1) / ranges;
    result.channels = columns_a_task * packed_columns;
    result.tile_ranges = (tiles + result.tiles - 1) / result.tiles;
    result.channel_ranges = (columns + columns_a_task - 1) / columns_a_task;
    return result;
}

template <typename Number>
void convolve_tiles(const ConvolutionShape& shape, const Number* x, const Number* packed,
                    const float* bias, Number* y) {
    const Division division = divide<Number>(shape);
    const int64_t tiles = shape.tiles(winograd_tile<Number>);
    const int64_t scratch_bytes =
        best_winograd_kernel<Number>()->scratch(division.tiles, shape.in_channels);
    parallel_ranges(
        division.tile_ranges * division.channel_ranges, 1, [&](int64_t first, int64_t last) {
            const at::Tensor scratch = at::empty({scratch_bytes}, at::kByte);
            for (int64_t task = first; task < last; ++task) {
                WinogradPart part;
                part.first_tile = task / division.channel_ranges * division.tiles;
                part.last_tile = std::min(tiles, part.first_tile + division.tiles);
                part.first_channel = task % division.channel_ranges * division.channels;
                part.last_channel =
                    std::min(shape.out_channels, part.first_channel + division.channels);
                best_winograd_kernel<Number>()->convolve(shape, x, packed, bias, y, part,
                                                         scratch.data_ptr());
            }
        });
}

}  // namespace

bool WinogradConvolution::gains(const at::Tensor& x, const at::Tensor& weight) {
    const int64_t pixels = x.size(0) * x.size(2) * x.size(3);
    // The packed weights in float32 take four times the memory of float32 weights, or eight times
    // the memory of float16 weights.
    constexpr int64_t few_weights = 1 << 20;
    const bool heavy = !is_bfloat16(x) && weight.numel() > few_weights;
    return fits(x, weight) && pixels >= (heavy ? 2048 : 512);
}

WinogradConvolution::WinogradConvolution(const at::Tensor& weight, at::ScalarType dtype,
                                         Forget release_pages)
    : FrozenConvolution(weight, dtype, dtype, std::move(release_pages)) {
    pack_forward();
}

int64_t WinogradConvolution::points() const {
    return dtype() == at::kBFloat16 ? winograd_points<BFloat16> : winograd_points<float>;
}

std::vector<int64_t> WinogradConvolution::turned_points() const {
    if (dtype() != at::kBFloat16) return {};
    // The points of tiles of 2 x 2 are 0, 1, -1 and infinity; rotating a kernel swaps the first and
    // the last.
    constexpr int64_t swapped[] = {3, 1, 2, 0};
    std::vector<int64_t> points;
    for (const int64_t row : swapped)
        for (const int64_t column : swapped)
            points.push_back(4 * row + column);
    return points;
}

void WinogradConvolution::pack_column(const void* weights, int64_t out_channels,
                                      int64_t in_channels, int64_t column, void* packed) const {
    if (dtype() == at::kBFloat16)
        best_winograd_kernel<BFloat16>()->pack(static_cast<const BFloat16*>(weights), out_channels,
                                               in_channels, column, static_cast<BFloat16*>(packed));
    else
        best_winograd_kernel<float>()->pack(static_cast<const float*>(weights), out_channels,
                                            in_channels, column, static_cast<float*>(packed));
}

at::Tensor WinogradConvolution::convolve(const at::Tensor& x, const at::Tensor& packed,
                                         int64_t out_channels, const at::Tensor& bias) const {
    const ConvolutionShape shape{x.size(0), x.size(2), x.size(3), x.size(1), out_channels};
    const at::Tensor y = at::empty({shape.images, out_channels, shape.height, shape.width},
                                   x.options().memory_format(at::MemoryFormat::ChannelsLast));
    const float* added = bias.defined() ? bias.data_ptr<float>() : nullptr;
    if (is_bfloat16(x))
        convolve_tiles(shape, numbers<const BFloat16>(x), numbers<const BFloat16>(packed), added,
                       numbers<BFloat16>(y));
    else
        convolve_tiles(shape, numbers<const float>(x), numbers<const float>(packed), added,
                       numbers<float>(y));
    return y;
}

}  // namespace item3d
