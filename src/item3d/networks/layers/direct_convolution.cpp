#include "item3d/networks/layers/direct_convolution.h"

#include "item3d/kernels/cpu/conv/direct_kernel.h"
#include "item3d/kernels/cpu/linear/amx_kernel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <algorithm>

namespace item3d {
namespace {

using std::int64_t;

template <typename Weight>
const auto& best_direct_kernel() {
    return kernel_for_this_processor<Multiplied<Weight>>(
        []<InstructionSet instructions> { return direct_kernel<instructions, Weight>(); });
}

template <typename Weight>
void convolve_any(const ConvolutionShape& shape, const at::Tensor& x, const at::Tensor& packed,
                  const float* bias, const at::Tensor& y) {
    using Number = Multiplied<Weight>;
    // Maximum number of pixels per task. Their inputs and sums fit into a core's cache, beside the
    // weights of one column (`packed_columns` output channels).
    constexpr int64_t max_pixels = 384;
    const int64_t pixels = shape.images * shape.height * shape.width;
    const int64_t ranges = (pixels + max_pixels - 1) / max_pixels;
    const int64_t each = (pixels + ranges - 1) / ranges;
    const int64_t columns = columns_of(shape.out_channels);
    parallel_ranges(ranges * columns, 1, [&](int64_t first, int64_t last) {
        const at::Tensor scratch =
            at::empty({best_direct_kernel<Weight>()->scratch(each, shape.in_channels)}, at::kByte);
        for (int64_t task = first; task < last; ++task) {
            PixelPart part;
            part.first_pixel = task % ranges * each;
            part.last_pixel = std::min(pixels, part.first_pixel + each);
            part.first_channel = task / ranges * packed_columns;
            part.last_channel = std::min(shape.out_channels, part.first_channel + packed_columns);
            best_direct_kernel<Weight>()->convolve(shape, static_cast<const Number*>(x.data_ptr()),
                                                   static_cast<const Weight*>(packed.data_ptr()),
                                                   bias, static_cast<Number*>(y.data_ptr()), part,
                                                   scratch.data_ptr());
        }
    });
}

/// Returns x [N, H, W, C] three times, shifted for convolve_taps_amx().
at::Tensor shifted_maps(const at::Tensor& x) {
    const int64_t images = x.size(0), height = x.size(1), width = x.size(2), channels = x.size(3);
    constexpr int64_t beyond = 16;
    const at::Tensor all =
        at::zeros({(3 * images * (height + 2) * width + beyond) * channels}, x.options());
    const at::Tensor maps = all.narrow(0, 0, 3 * images * (height + 2) * width * channels)
                                .view({3, images, height + 2, width, channels})
                                .narrow(2, 1, height);
    maps[0].narrow(2, 1, width - 1).copy_(x.narrow(2, 0, width - 1));
    maps[1].copy_(x);
    maps[2].narrow(2, 0, width - 1).copy_(x.narrow(2, 1, width - 1));
    return all;
}

void convolve_in_units(const ConvolutionShape& shape, const at::Tensor& x, const at::Tensor& packed,
                       const float* bias, const at::Tensor& y) {
    // Maximum number of tiles per task. Their sums fit into a core's cache, beside the weights of
    // one column (`packed_columns` output channels).
    constexpr int64_t max_tiles = 32;
    const int64_t tiles = unit_tiles(shape);
    const int64_t ranges = (tiles + max_tiles - 1) / max_tiles;
    const int64_t each = (tiles + ranges - 1) / ranges;
    const at::Tensor shifted = shifted_maps(x.permute({0, 2, 3, 1}));
    parallel_ranges(
        ranges * (shape.out_channels / packed_columns), 1, [&](int64_t first, int64_t last) {
            const at::Tensor scratch = at::empty({unit_taps_scratch(each)}, at::kByte);
            for (int64_t task = first; task < last; ++task) {
                TilePart part;
                part.first_tile = task % ranges * each;
                part.last_tile = std::min(tiles, part.first_tile + each);
                part.first_channel = task / ranges * packed_columns;
                part.last_channel = part.first_channel + packed_columns;
                convolve_taps_amx(shape, static_cast<const BFloat16*>(shifted.data_ptr()),
                                  static_cast<const BFloat16*>(packed.data_ptr()), bias,
                                  static_cast<BFloat16*>(y.data_ptr()), part, scratch.data_ptr());
            }
        });
}

/// Returns the type of packed weights. Weights that are stored as float16 stay float16, which
/// halves the memory without loss.
at::ScalarType type_of_packed(const at::Tensor& weight, at::ScalarType maps) {
    const bool rounded = weight.scalar_type() == at::kHalf && maps == at::kFloat;
    return rounded ? at::kHalf : maps;
}

template <typename Weight>
void pack_any(const void* weights, int64_t out_channels, int64_t in_channels, int64_t column,
              void* packed) {
    best_direct_kernel<Weight>()->pack(static_cast<const Weight*>(weights), out_channels,
                                       in_channels, column, static_cast<Weight*>(packed));
}

}  // namespace

bool DirectConvolution::gains(const at::Tensor& x, const at::Tensor& weight) {
    return fits(x, weight);
}

DirectConvolution::DirectConvolution(const at::Tensor& weight, at::ScalarType dtype,
                                     Forget release_pages)
    : FrozenConvolution(weight, dtype, type_of_packed(weight, dtype), std::move(release_pages)) {
    pack_forward();
}

std::vector<int64_t> DirectConvolution::turned_points() const {
    return {8, 7, 6, 5, 4, 3, 2, 1, 0};
}

void DirectConvolution::pack_column(const void* weights, int64_t out_channels, int64_t in_channels,
                                    int64_t column, void* packed) const {
    const auto pack = packed_dtype() == at::kBFloat16 ? pack_any<BFloat16>
                      : packed_dtype() == at::kHalf   ? pack_any<Float16>
                                                      : pack_any<float>;
    pack(weights, out_channels, in_channels, column, packed);
}

at::Tensor DirectConvolution::convolve(const at::Tensor& x, const at::Tensor& packed,
                                       int64_t out_channels, const at::Tensor& bias) const {
    const ConvolutionShape shape{x.size(0), x.size(2), x.size(3), x.size(1), out_channels};
    const at::Tensor y = at::empty({shape.images, out_channels, shape.height, shape.width},
                                   x.options().memory_format(at::MemoryFormat::ChannelsLast));
    const float* added = bias.defined() ? bias.data_ptr<float>() : nullptr;
    const bool in_units = packed_dtype() == at::kBFloat16 && amx_available();
    const auto run = in_units                          ? convolve_in_units
                     : packed_dtype() == at::kBFloat16 ? convolve_any<BFloat16>
                     : packed_dtype() == at::kHalf     ? convolve_any<Float16>
                                                       : convolve_any<float>;
    run(shape, x, packed, added, y);
    return y;
}

}  // namespace item3d
