#include "item3d/networks/layers/recompute.h"

#include <torch/csrc/autograd/autograd.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/custom_class.h>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;
using Step = std::function<at::Tensor(const at::Tensor&)>;

struct StepHolder : torch::CustomClassHolder {
    explicit StepHolder(Step held) : step(std::move(held)) {}
    Step step;
};

struct Recomputed : torch::autograd::Function<Recomputed> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& x, const Step& step) {
        context->save_for_backward({x});
        context->saved_data["step"] = c10::IValue::make_capsule(
            c10::intrusive_ptr<torch::CustomClassHolder>(c10::make_intrusive<StepHolder>(step)));
        return step(x);
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto holder = context->saved_data["step"].toCapsule();
        const at::AutoGradMode with_gradients(true);
        const at::Tensor x = context->get_saved_variables()[0].detach().requires_grad_(true);
        const at::Tensor y = static_cast<const StepHolder&>(*holder).step(x);
        return {torch::autograd::grad({y}, {x}, {gradients[0]})[0], at::Tensor()};
    }
};

}  // namespace

at::Tensor recomputed(Step f, const at::Tensor& x) {
    if (!at::GradMode::is_enabled() || !x.requires_grad()) return f(x);
    return Recomputed::apply(x, f);
}

}  // namespace item3d
