#include "item3d/models/direct_convolution.h"

#include "item3d/models/direct_kernel.h"

#include <ATen/Parallel.h>

#include <algorithm>

namespace item3d {
namespace {

using std::int64_t;

template <typename Number>
torch::Tensor pack_weight(const torch::Tensor& weight) {
    const int64_t out = weight.size(0), in = weight.size(1);
    const torch::Tensor ordered = weight.contiguous(torch::MemoryFormat::ChannelsLast);
    const torch::Tensor packed = torch::empty({9 * out * in}, weight.options());
    const auto* from = static_cast<const Number*>(ordered.data_ptr());
    auto* to = static_cast<Number*>(packed.data_ptr());
    at::parallel_for(0, out / packed_columns, 1, [&](int64_t first, int64_t last) {
        pack_taps(from, out, in, first * packed_columns, last * packed_columns, to);
    });
    return packed;
}

torch::Tensor pack_any(const torch::Tensor& weight) {
    return weight.scalar_type() == torch::kBFloat16 ? pack_weight<BrainFloat>(weight)
                                                    : pack_weight<float>(weight);
}

template <typename Number>
void convolve_any(const ConvolutionShape& shape, const torch::Tensor& x,
                  const torch::Tensor& packed, const float* bias, const torch::Tensor& y) {
    // As many as keep a column's sums and their inputs in a core's cache, beside its weights.
    constexpr int64_t most_pixels = 384;
    const int64_t pixels = shape.pictures * shape.height * shape.width;
    const int64_t ranges = (pixels + most_pixels - 1) / most_pixels;
    const int64_t each = (pixels + ranges - 1) / ranges;
    const int64_t columns = shape.out_channels / packed_columns;
    at::parallel_for(0, ranges * columns, 1, [&](int64_t first, int64_t last) {
        const torch::Tensor scratch =
            torch::empty({taps_scratch<Number>(each, shape.in_channels)}, torch::kUInt8);
        for (int64_t task = first; task < last; ++task) {
            PixelPart part;
            part.first_pixel = task % ranges * each;
            part.last_pixel = std::min(pixels, part.first_pixel + each);
            part.first_channel = task / ranges * packed_columns;
            part.last_channel = part.first_channel + packed_columns;
            convolve_taps(shape, static_cast<const Number*>(x.data_ptr()),
                          static_cast<const Number*>(packed.data_ptr()), bias,
                          static_cast<Number*>(y.data_ptr()), part, scratch.data_ptr());
        }
    });
}

}  // namespace

bool DirectConvolution::gains(const torch::Tensor& x, const torch::Tensor& weight) {
    return fits(x, weight);
}

DirectConvolution::DirectConvolution(const torch::Tensor& weight)
    : FrozenConvolution(weight, pack_any(weight.detach())) {}

torch::Tensor DirectConvolution::pack(const torch::Tensor& weight) const {
    return pack_any(weight);
}

torch::Tensor DirectConvolution::turn_round(const torch::Tensor& packed) const {
    const int64_t group = dtype() == torch::kBFloat16 ? 2 : 1;
    const int64_t out = out_channels(), in = in_channels();
    return packed.view({9, out / packed_columns, in / group, packed_columns, group})
        .flip({0})
        .permute({0, 2, 4, 1, 3})  // [9, in / group, group, out / columns, columns]
        .reshape({9, in / packed_columns, packed_columns, out / group, group})
        .permute({0, 1, 3, 2, 4})
        .reshape({-1})
        .contiguous();
}

torch::Tensor DirectConvolution::convolve(const torch::Tensor& x, const torch::Tensor& packed,
                                          int64_t out_channels, const torch::Tensor& bias) const {
    const ConvolutionShape shape{x.size(0), x.size(2), x.size(3), x.size(1), out_channels};
    const torch::Tensor y =
        torch::empty({shape.pictures, out_channels, shape.height, shape.width},
                     x.options().memory_format(torch::MemoryFormat::ChannelsLast));
    const float* added = bias.defined() ? bias.data_ptr<float>() : nullptr;
    const auto run = dtype() == torch::kBFloat16 ? convolve_any<BrainFloat> : convolve_any<float>;
    run(shape, x, packed, added, y);
    return y;
}

}  // namespace item3d
