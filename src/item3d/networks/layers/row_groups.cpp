#include "item3d/networks/layers/row_groups.h"

#include "item3d/core/parallel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <torch/csrc/autograd/autograd.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/custom_class.h>

#include <algorithm>
#include <vector>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// A range of a batch's elements, with the autograd graph of their results.
struct RowGroup {
    std::int64_t first, count;
    at::Tensor text, result;
};

/// Divides a batch into at most max_groups groups of equal size, at least two elements. The last
/// group may be smaller. One element alone takes more than half the time of two.
std::vector<RowGroup> make_groups(std::int64_t rows) {
    constexpr std::int64_t fewest_rows = 2, max_groups = 16;
    const std::int64_t each = std::max(fewest_rows, (rows + max_groups - 1) / max_groups);
    std::vector<RowGroup> groups;
    for (std::int64_t first = 0; first < rows; first += each)
        groups.push_back({first, std::min(each, rows - first), {}, {}});
    return groups;
}

template <typename Function>
void for_each_group(std::vector<RowGroup>& groups, const Function& f) {
    const auto count = static_cast<std::int64_t>(groups.size());
    parallel_ranges(count, 1, [&](std::int64_t begin, std::int64_t end) {
        const OneThread alone;
        for (std::int64_t i = begin; i < end; ++i)
            f(groups[static_cast<std::size_t>(i)]);
    });
}

void run_groups(std::vector<RowGroup>& groups, const at::Tensor& text, const RowFunction& f,
                bool differentiable) {
    for_each_group(groups, [&](RowGroup& group) {
        const at::AutoGradMode mode(differentiable);  // each thread has its own mode
        group.text = text.detach().narrow(0, group.first, group.count);
        if (differentiable) group.text = group.text.detach().requires_grad_(true);
        group.result = f(group.first, group.count, group.text);
    });
}

at::Tensor joined(const std::vector<RowGroup>& groups, at::Tensor RowGroup::*part) {
    std::vector<at::Tensor> parts;
    for (const RowGroup& group : groups)
        parts.push_back((group.*part).detach());
    return at::cat(parts);
}

struct GroupsHolder : torch::CustomClassHolder {
    explicit GroupsHolder(std::vector<RowGroup> held) : groups(std::move(held)) {}
    std::vector<RowGroup> groups;
};

struct GroupsStep : torch::autograd::Function<GroupsStep> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& text,
                              const RowFunction& f) {
        std::vector<RowGroup> groups = make_groups(text.size(0));
        run_groups(groups, text, f, true);
        const at::Tensor result = joined(groups, &RowGroup::result);
        context->saved_data["groups"] =
            c10::IValue::make_capsule(c10::intrusive_ptr<torch::CustomClassHolder>(
                c10::make_intrusive<GroupsHolder>(std::move(groups))));
        return result;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto holder = context->saved_data["groups"].toCapsule();
        std::vector<RowGroup> groups = static_cast<const GroupsHolder&>(*holder).groups;
        for_each_group(groups, [&](RowGroup& group) {
            const at::Tensor gradient = gradients[0].narrow(0, group.first, group.count);
            group.text = torch::autograd::grad({group.result}, {group.text}, {gradient},
                                               /*retain_graph=*/true)[0];
        });
        return {joined(groups, &RowGroup::text), at::Tensor()};
    }
};

}  // namespace

at::Tensor in_row_groups(const at::Tensor& text, const RowFunction& f) {
    if (at::GradMode::is_enabled() && text.requires_grad()) return GroupsStep::apply(text, f);
    std::vector<RowGroup> groups = make_groups(text.size(0));
    run_groups(groups, text, f, false);
    return joined(groups, &RowGroup::result);
}

}  // namespace item3d
