#include "item3d/render/srgb.h"

#include "item3d/core/error.h"
#include "item3d/render/dispatch.h"
#include "item3d/render/kernels/srgb.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;
using CurveKernel = cuda::Kernel<kernels::CurveParameters> cuda::RenderTable::*;

constexpr std::int64_t curve_grain = 4096;

/// An elementwise autograd function. The kernels of its value and its gradient are given for the
/// CPU, and as entries of the device's table.
template <auto forward_kernel, auto backward_kernel, CurveKernel forward_entry,
          CurveKernel backward_entry>
struct Curve : torch::autograd::Function<
                   Curve<forward_kernel, backward_kernel, forward_entry, backward_entry>> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& in_) {
        const at::Tensor in = in_.contiguous();
        const at::Tensor out = at::empty_like(in);
        const kernels::CurveParameters p{in.const_data_ptr<float>(), nullptr,
                                         out.data_ptr<float>()};
        dispatch<forward_kernel>(in.device(), "srgb", forward_entry, p, in.numel(), curve_grain);
        context->save_for_backward({in});
        return out;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const at::Tensor in = context->get_saved_variables()[0];
        const at::Tensor gradient = gradients[0].contiguous();
        const at::Tensor out = at::empty_like(in);
        const kernels::CurveParameters p{in.const_data_ptr<float>(),
                                         gradient.const_data_ptr<float>(), out.data_ptr<float>()};
        dispatch<backward_kernel>(in.device(), "srgb backward", backward_entry, p, in.numel(),
                                  curve_grain);
        return {out};
    }
};

using LinearToSrgb =
    Curve<kernels::linear_to_srgb, kernels::linear_to_srgb_backward,
          &cuda::RenderTable::linear_to_srgb, &cuda::RenderTable::linear_to_srgb_backward>;
using SrgbToLinear =
    Curve<kernels::srgb_to_linear, kernels::srgb_to_linear_backward,
          &cuda::RenderTable::srgb_to_linear, &cuda::RenderTable::srgb_to_linear_backward>;

}  // namespace

at::Tensor linear_to_srgb(const at::Tensor& linear) {
    ITEM3D_CHECK(linear.scalar_type() == at::kFloat, "linear_to_srgb takes float32");
    return LinearToSrgb::apply(linear);
}

at::Tensor srgb_to_linear(const at::Tensor& encoded) {
    ITEM3D_CHECK(encoded.scalar_type() == at::kFloat, "srgb_to_linear takes float32");
    return SrgbToLinear::apply(encoded);
}

}  // namespace item3d
