#include "item3d/processes/shared_rows.h"

#include <torch/csrc/autograd/custom_function.h>

#include <vector>

namespace item3d {
namespace {

at::Tensor summed_rows(const ProcessGroup& processes, const at::Tensor& own, std::int64_t first,
                       std::int64_t total) {
    std::vector<std::int64_t> sizes = own.sizes().vec();
    sizes[0] = total;
    at::Tensor all = at::zeros(sizes, own.options().requires_grad(false));
    if (own.size(0) > 0) all.narrow(0, first, own.size(0)).copy_(own.detach());
    processes.sum(all);
    return all;
}

struct GatherRows : torch::autograd::Function<GatherRows> {
    /// The values for the backward pass that are not tensors.
    struct Rows : torch::CustomClassHolder {
        ProcessGroup processes;
        std::int64_t first = 0, count = 0;
    };

    static at::Tensor forward(torch::autograd::AutogradContext* context, const at::Tensor& own,
                              const ProcessGroup& processes, std::int64_t first,
                              std::int64_t total) {
        auto rows = c10::make_intrusive<Rows>();
        rows->processes = processes;
        rows->first = first;
        rows->count = own.size(0);
        context->saved_data["rows"] = c10::IValue::make_capsule(rows);
        return summed_rows(processes, own, first, total);
    }

    static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                   torch::autograd::variable_list gradients) {
        const auto capsule = context->saved_data["rows"].toCapsule();
        const auto& rows = static_cast<const Rows&>(*capsule);
        at::Tensor sum = gradients[0].contiguous().clone();
        rows.processes.sum(sum);
        return {sum.narrow(0, rows.first, rows.count), at::Tensor(), at::Tensor(), at::Tensor()};
    }
};

}  // namespace

at::Tensor gather_rows(const ProcessGroup& processes, const at::Tensor& own, std::int64_t first,
                       std::int64_t total) {
    if (!processes.several()) return own;
    return GatherRows::apply(own, processes, first, total);
}

at::Tensor compute_rows(const ProcessGroup& processes, std::int64_t total, at::IntArrayRef row,
                        at::TensorOptions options,
                        const std::function<at::Tensor(std::int64_t, std::int64_t)>& rows) {
    if (!processes.several()) return rows(0, total);
    const Share share = processes.share(total);
    std::vector<std::int64_t> sizes{share.count};
    sizes.insert(sizes.end(), row.begin(), row.end());
    const at::Tensor own =
        share.count > 0 ? rows(share.first, share.count).detach() : at::empty(sizes, options);
    return summed_rows(processes, own, share.first, total);
}

}  // namespace item3d
