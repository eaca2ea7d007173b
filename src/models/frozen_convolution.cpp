#include "item3d/models/frozen_convolution.h"

#include "item3d/core/error.h"
#include "item3d/models/direct_convolution.h"
#include "item3d/models/matrix_kernel.h"
#include "item3d/models/winograd.h"

namespace item3d {
namespace {

bool kernel_runs(torch::Dtype dtype) {
    static const bool float_runs = matrix_kernel_runs<float>();
    static const bool bfloat_runs = matrix_kernel_runs<BrainFloat>();
    return (dtype == torch::kFloat32 && float_runs) || (dtype == torch::kBFloat16 && bfloat_runs);
}

}  // namespace

std::shared_ptr<FrozenConvolution> FrozenConvolution::make(const torch::Tensor& x,
                                                           const torch::Tensor& weight) {
    if (WinogradConvolution::gains(x, weight)) return std::make_shared<WinogradConvolution>(weight);
    if (DirectConvolution::gains(x, weight)) return std::make_shared<DirectConvolution>(weight);
    return nullptr;
}

bool FrozenConvolution::fits(const torch::Tensor& x, const torch::Tensor& weight) {
    return x.is_cpu() && x.scalar_type() == weight.scalar_type() && kernel_runs(x.scalar_type()) &&
           weight.size(0) % packed_columns == 0 && weight.size(1) % packed_columns == 0;
}

FrozenConvolution::FrozenConvolution(const torch::Tensor& weight, torch::Tensor packed)
    : out_channels_(weight.size(0)),
      in_channels_(weight.size(1)),
      dtype_(weight.scalar_type()),
      weight_(weight.detach()),
      version_(static_cast<std::uint32_t>(weight._version())),
      packed_(std::move(packed)) {}

bool FrozenConvolution::is_of(const torch::Tensor& weight) const {
    return weight_.defined() && weight.data_ptr() == weight_.data_ptr() &&
           weight.strides() == weight_.strides() &&
           static_cast<std::uint32_t>(weight_._version()) == version_;
}

bool FrozenConvolution::forget_weight() {
    if (!can_turn_round()) return false;
    weight_ = torch::Tensor();
    return true;
}

torch::Tensor FrozenConvolution::run(const torch::Tensor& x, const torch::Tensor& packed,
                                     std::int64_t out_channels, const torch::Tensor& bias) const {
    torch::Tensor float_bias;
    if (bias.defined()) float_bias = bias.to(torch::kFloat32).contiguous();
    return convolve(x.contiguous(torch::MemoryFormat::ChannelsLast), packed, out_channels,
                    float_bias);
}

torch::Tensor FrozenConvolution::forward(const torch::Tensor& x, const torch::Tensor& bias) const {
    ITEM3D_CHECK(x.dim() == 4 && x.size(1) == in_channels_ && x.scalar_type() == dtype_,
                 "x must be [N, C, H, W] with the weights' channels and type");
    return run(x, packed_, out_channels_, bias);
}

torch::Tensor FrozenConvolution::backward(const torch::Tensor& gradient) {
    // The way back is the convolution with the weights turned round and their channels swapped.
    if (!packed_backward_.defined())
        packed_backward_ =
            can_turn_round() ? turn_round(packed_) : pack(weight_.flip({2, 3}).transpose(0, 1));
    return run(gradient.to(dtype_), packed_backward_, in_channels_, {});
}

}  // namespace item3d
