#include "item3d/networks/layers/frozen_convolution.h"

#include "item3d/core/error.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"
#include "item3d/kernels/cpu/linear/weight_kernel.h"
#include "item3d/networks/layers/direct_convolution.h"
#include "item3d/networks/layers/winograd.h"
#include "item3d/tensors/parallel_ranges.h"
#include "item3d/tensors/weight_memory.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr std::int64_t taps = 9;

/// Returns the number that must divide the channel counts for maps of this type; 0 if this
/// processor has no kernel for the type.
std::int64_t channel_step(at::ScalarType dtype) {
    if (dtype == at::kFloat && instruction_set_for<float>() != InstructionSet::none)
        return register_numbers;
    if (dtype == at::kBFloat16 && instruction_set_for<BFloat16>() != InstructionSet::none)
        return packed_columns;
    return 0;
}

bool can_be_packed(at::ScalarType stored) {
    return stored == at::kFloat || stored == at::kBFloat16 || stored == at::kHalf;
}

template <typename Number>
void order_rows(const at::Tensor& weight, std::int64_t first, std::int64_t rows,
                const at::Tensor& ordered) {
    const auto& kernel = kernel_for_this_processor<Multiplied<Number>>(
        []<InstructionSet instructions> { return weight_kernel<instructions, Number>(); });
    const std::int64_t in = weight.size(1), start = first * in * taps;
    auto* to = static_cast<Number*>(ordered.data_ptr());
    const void* from = weight.const_data_ptr();
    if (weight.scalar_type() == at::kHalf)
        kernel->order_halves(static_cast<const Float16*>(from) + start, rows, in, to);
    else if (weight.scalar_type() == at::kBFloat16)
        kernel->order_bfloat16(static_cast<const BFloat16*>(from) + start, rows, in, to);
    else
        kernel->order_floats(static_cast<const float*>(from) + start, rows, in, to);
}

/// Transposes a block of 64 input and 64 output channels: [in, out] -> [out, in].
template <typename Number>
void swap_channels(const Number* from, Number* to) {
    for (std::int64_t out = 0; out < packed_columns; ++out)
        for (std::int64_t in = 0; in < packed_columns; ++in)
            to[out * packed_columns + in] = from[in * packed_columns + out];
}

/// Transposes bfloat16, [in / 2, out, 2] -> [out / 2, in, 2]. Moves four values at a time, for two
/// input and two output channels.
template <>
void swap_channels(const std::uint64_t* from, std::uint64_t* to) {
    constexpr std::int64_t pairs = packed_columns / 2;
    constexpr std::uint64_t outer = 0xffff00000000ffff, inner = 0xffff0000;
    for (std::int64_t out = 0; out < pairs; ++out)
        for (std::int64_t in = 0; in < pairs; ++in) {
            const std::uint64_t four = from[in * pairs + out];
            to[out * pairs + in] = (four & outer) | (four >> 16 & inner) | (four & inner) << 16;
        }
}

}  // namespace

std::shared_ptr<FrozenConvolution> FrozenConvolution::make(const at::Tensor& x,
                                                           const at::Tensor& weight,
                                                           const Forget& release_pages) {
    if (WinogradConvolution::gains(x, weight))
        return std::make_shared<WinogradConvolution>(weight, x.scalar_type(), release_pages);
    if (DirectConvolution::gains(x, weight))
        return std::make_shared<DirectConvolution>(weight, x.scalar_type(), release_pages);
    return nullptr;
}

bool FrozenConvolution::fits(const at::Tensor& x, const at::Tensor& weight) {
    const std::int64_t step = channel_step(x.scalar_type());
    return x.is_cpu() && step > 0 && can_be_packed(weight.scalar_type()) &&
           weight.size(0) % step == 0 && weight.size(1) % step == 0;
}

FrozenConvolution::FrozenConvolution(const at::Tensor& weight, at::ScalarType dtype,
                                     at::ScalarType packed, Forget release_pages)
    : out_channels_(weight.size(0)),
      in_channels_(weight.size(1)),
      dtype_(dtype),
      packed_dtype_(packed),
      weight_(weight.detach()),
      version_(static_cast<std::uint32_t>(weight._version())),
      release_pages_(std::move(release_pages)) {}

void FrozenConvolution::pack_forward() {
    packed_ = pack(weight_);
}

bool FrozenConvolution::is_of(const at::Tensor& weight) const {
    return weight_.defined() && weight.data_ptr() == weight_.data_ptr() &&
           weight.strides() == weight_.strides() &&
           static_cast<std::uint32_t>(weight_._version()) == version_;
}

bool FrozenConvolution::release_weight() {
    if (turned_round().empty()) return false;
    weight_ = at::Tensor();
    return true;
}

std::vector<std::int64_t> FrozenConvolution::turned_round() const {
    const bool whole = out_channels_ % packed_columns == 0 && in_channels_ % packed_columns == 0;
    return whole ? turned_points() : std::vector<std::int64_t>();
}

at::Tensor FrozenConvolution::pack(const at::Tensor& weight) const {
    const std::int64_t out = weight.size(0), in = weight.size(1);
    const bool ordered = weight.scalar_type() == packed_dtype_ &&
                         weight.is_contiguous(at::MemoryFormat::ChannelsLast);
    const at::Tensor source = ordered ? weight : weight.contiguous();
    const auto order = packed_dtype_ == at::kHalf       ? order_rows<Float16>
                       : packed_dtype_ == at::kBFloat16 ? order_rows<BFloat16>
                                                        : order_rows<float>;
    const at::Tensor packed = empty_weight({points() * out * in}, packed_dtype_);
    parallel_ranges(columns_of(out), 1, [&](std::int64_t first, std::int64_t last) {
        at::Tensor scratch;
        if (!ordered) scratch = at::empty({packed_columns * taps * in}, packed_dtype_);
        const std::int64_t end = std::min(out, last * packed_columns);
        for (std::int64_t column = first * packed_columns; column < end; column += packed_columns) {
            const char* rows = nullptr;
            if (ordered) {
                rows = static_cast<const char*>(source.data_ptr()) +
                       static_cast<std::size_t>(column * taps * in) * source.element_size();
            } else {
                order(source, column, std::min(packed_columns, end - column), scratch);
                rows = static_cast<const char*>(scratch.data_ptr());
            }
            pack_column(rows, out, in, column, packed.data_ptr());
        }
    });
    if (release_pages_) release_pages_();
    return packed;
}

at::Tensor FrozenConvolution::turn_round(const std::vector<std::int64_t>& points) const {
    const auto count = static_cast<std::int64_t>(points.size());
    const at::Tensor turned =
        at::empty({count * in_channels_ * out_channels_}, at::dtype(packed_dtype_));
    const std::int64_t outs = out_channels_ / packed_columns, ins = in_channels_ / packed_columns;
    constexpr std::int64_t square = packed_columns * packed_columns;
    // Transposes one block of channels. A Number contains `numbers` packed values, which move
    // together.
    const auto swap = [&]<typename Number>(std::int64_t numbers, std::int64_t from,
                                           std::int64_t to) {
        swap_channels(static_cast<const Number*>(packed_.data_ptr()) + from / numbers,
                      static_cast<Number*>(turned.data_ptr()) + to / numbers);
    };
    parallel_ranges(count * ins, 1, [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t i = first; i < last; ++i) {
            const std::int64_t point = points[static_cast<std::size_t>(i / ins)], in = i % ins;
            for (std::int64_t out = 0; out < outs; ++out) {
                const std::int64_t from = ((point * outs + out) * ins + in) * square;
                const std::int64_t to = (i * outs + out) * square;
                if (packed_dtype_ == at::kBFloat16)
                    swap.operator()<std::uint64_t>(4, from, to);
                else if (packed_dtype_ == at::kHalf)
                    swap.operator()<std::uint16_t>(1, from, to);
                else
                    swap.operator()<float>(1, from, to);
            }
        }
    });
    return turned;
}

at::Tensor FrozenConvolution::run(const at::Tensor& x, const at::Tensor& packed,
                                  std::int64_t out_channels, const at::Tensor& bias) const {
    at::Tensor float_bias;
    if (bias.defined()) float_bias = bias.to(at::kFloat).contiguous();
    return convolve(x.contiguous(at::MemoryFormat::ChannelsLast), packed, out_channels, float_bias);
}

at::Tensor FrozenConvolution::forward(const at::Tensor& x, const at::Tensor& bias) const {
    ITEM3D_CHECK(x.dim() == 4 && x.size(1) == in_channels_ && x.scalar_type() == dtype_,
                 "x must be [N, C, H, W] with the weights' channels and the packed type");
    return run(x, packed_, out_channels_, bias);
}

at::Tensor FrozenConvolution::backward(const at::Tensor& gradient) {
    return run(gradient.to(dtype_), packed_for_backward(), in_channels_, {});
}

at::Tensor FrozenConvolution::packed_for_backward() {
    const std::lock_guard lock(mutex_);
    if (packed_backward_.defined()) return packed_backward_;
    // The backward pass is the convolution with rotated kernels and swapped channels.
    const at::NoGradGuard no_grad;
    const std::vector<std::int64_t> points = turned_round();
    const at::Tensor packed =
        points.empty() ? pack(weight_.flip({2, 3}).transpose(0, 1)) : turn_round(points);
    // Rotating large weights again costs little compared with the convolution, whereas keeping the
    // rotated ones costs much memory.
    constexpr std::size_t max_kept = 5 << 20;
    if (points.empty() || packed.nbytes() <= max_kept) packed_backward_ = packed;
    return packed;
}

}  // namespace item3d
