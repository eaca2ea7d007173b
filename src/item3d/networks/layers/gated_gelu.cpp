#include "item3d/networks/layers/gated_gelu.h"

#include "item3d/kernels/cpu/linear/gate_kernel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <vector>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

template <typename Number>
const auto& gate() {
    return kernel_for_this_processor<Number>(
        []<InstructionSet instructions> { return gate_kernel<instructions, Number>(); });
}

/// Calls f(first row, rows) on all threads, for x [..., 2 width].
template <typename Function>
void for_each_gated_row(const at::Tensor& x, const Function& f) {
    constexpr std::int64_t fewest_numbers = 1 << 14;  // per thread
    const std::int64_t numbers = x.size(-1), rows = x.numel() / numbers;
    parallel_ranges(rows, std::max<std::int64_t>(1, fewest_numbers / numbers),
                    [&](std::int64_t first, std::int64_t last) { f(first, last - first); });
}

template <typename Number>
void run_gate(const at::Tensor& x, const at::Tensor& y) {
    const auto* from = static_cast<const Number*>(x.data_ptr());
    auto* to = static_cast<Number*>(y.data_ptr());
    const std::int64_t width = y.size(-1);
    for_each_gated_row(x, [&](std::int64_t first, std::int64_t rows) {
        gate<Number>()->apply(from + 2 * first * width, rows, width, to + first * width);
    });
}

template <typename Number>
void run_gate_back(const at::Tensor& x, const at::Tensor& dy, const at::Tensor& dx) {
    const auto *from = static_cast<const Number*>(x.data_ptr()),
               *gradient = static_cast<const Number*>(dy.data_ptr());
    auto* to = static_cast<Number*>(dx.data_ptr());
    const std::int64_t width = dy.size(-1);
    for_each_gated_row(x, [&](std::int64_t first, std::int64_t rows) {
        const std::int64_t begin = 2 * first * width;
        gate<Number>()->apply_gradient(from + begin, gradient + first * width, rows, width,
                                       to + begin);
    });
}

struct GateStep : torch::autograd::Function<GateStep> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& input) {
        const at::Tensor x = input.contiguous();
        std::vector<std::int64_t> sizes = x.sizes().vec();
        sizes.back() /= 2;
        const at::Tensor y = at::empty(sizes, x.options());
        (x.scalar_type() == at::kBFloat16 ? run_gate<BFloat16> : run_gate<float>)(x, y);
        context->save_for_backward({x});
        return y;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const at::Tensor x = context->get_saved_variables()[0];
        const at::Tensor dy = gradients[0].to(x.scalar_type()).contiguous();
        const at::Tensor dx = at::empty_like(x);
        const bool brain = x.scalar_type() == at::kBFloat16;
        (brain ? run_gate_back<BFloat16> : run_gate_back<float>)(x, dy, dx);
        return {dx};
    }
};

}  // namespace

at::Tensor gated_gelu(const at::Tensor& x) {
    const bool runs = (x.scalar_type() == at::kFloat && gate<float>()) ||
                      (x.scalar_type() == at::kBFloat16 && gate<BFloat16>());
    if (x.is_cpu() && runs && x.size(-1) % (2 * register_numbers) == 0) return GateStep::apply(x);
    const auto halves = x.chunk(2, -1);
    return halves[0] * at::gelu(halves[1]);
}

}  // namespace item3d
