#include "item3d/field/adam.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/field/cuda/module.h"
#include "item3d/tensors/sparse_rows.h"

#include <cmath>
#include <type_traits>

namespace item3d {
namespace {

AdamRates make_rates(const AdamOptions& options, int updates) {
    return {static_cast<float>(options.beta1), static_cast<float>(options.beta2),
            static_cast<float>(options.epsilon),
            static_cast<float>(options.learning_rate / (1.0 - std::pow(options.beta1, updates))),
            static_cast<float>(1.0 / (1.0 - std::pow(options.beta2, updates)))};
}

/// Returns `rates`, which are indexed by the number of updates, as a tensor on `device`. On the CPU
/// the tensor is a view of `rates`.
at::Tensor rates_on(std::vector<AdamRates>& rates, at::Device device) {
    static_assert(std::is_trivially_copyable_v<AdamRates>);
    return at::from_blob(rates.data(),
                         {static_cast<std::int64_t>(rates.size() * sizeof(AdamRates))}, at::kByte)
        .to(device);
}

}  // namespace

void Adam::add_group(const std::string& name, std::vector<at::Tensor> parameters,
                     const AdamOptions& options) {
    for (const Group& other : groups_)
        ITEM3D_CHECK(other.name != name, "two groups of parameters have the name " + name);
    Group group{name, {}, options};
    const at::Tensor& factors = options.row_factors;
    ITEM3D_CHECK(!factors.defined() ||
                     (parameters.size() == 1 && factors.numel() == parameters.front().size(0) &&
                      factors.scalar_type() == at::kFloat && factors.is_contiguous() &&
                      factors.device() == parameters.front().device()),
                 "row factors need one float32 for each row of the group's only parameter");
    for (at::Tensor& parameter : parameters) {
        ITEM3D_CHECK((parameter.is_cpu() || parameter.is_cuda()) && parameter.is_contiguous() &&
                         parameter.dim() > 0 && parameter.scalar_type() == at::kFloat,
                     "Adam updates contiguous float32 tensors on the CPU or CUDA");
        Slot slot;
        slot.parameter = parameter;
        slot.momentum = at::zeros_like(parameter, at::TensorOptions().requires_grad(false));
        slot.variance = at::zeros_like(slot.momentum);
        slot.updates = at::zeros({parameter.size(0)}, slot.momentum.options().dtype(at::kInt));
        group.slots.push_back(std::move(slot));
    }
    groups_.push_back(std::move(group));
}

AdamOptions& Adam::options(const std::string& group) {
    for (Group& own : groups_)
        if (own.name == group) return own.options;
    ITEM3D_CHECK(false, "unknown group of parameters " + group);
}

std::vector<at::Tensor> Adam::parameters() const {
    std::vector<at::Tensor> all;
    for (const Group& group : groups_)
        for (const Slot& slot : group.slots)
            all.push_back(slot.parameter);
    return all;
}

bool Adam::has_finite_gradients() const {
    // One infinite or NaN term makes the sum of all gradients infinite or NaN.
    at::Tensor sum;
    for (const at::Tensor& parameter : parameters()) {
        if (!parameter.grad().defined()) continue;
        const at::Tensor gradient = parameter.grad().detach();
        const at::Tensor own = (gradient.is_sparse() ? gradient._values() : gradient).sum();
        sum = sum.defined() ? sum + own : own;
    }
    return !sum.defined() || std::isfinite(sum.item<float>());
}

void Adam::step() {
    const at::NoGradGuard no_grad;
    const bool finite = has_finite_gradients();
    if (failed_.too_many_after(!finite))
        throw InputError("optimisation",
                         fmt::format("the gradients of {} steps in a row are not finite numbers",
                                     failed_.limit()),
                         "look for extreme values in the model, its textures and the lights");
    if (!finite) return;
    ++max_updates_;
    for (Group& group : groups_) {
        // Rows differ in their number of updates, but many have the same number, so the powers are
        // computed once for each possible number.
        std::vector<AdamRates> rates;
        for (int updates = 0; updates <= max_updates_; ++updates) {
            rates.push_back(make_rates(group.options, std::max(1, updates)));
        }
        for (Slot& slot : group.slots) {
            at::Tensor gradient = slot.parameter.grad();
            if (!gradient.defined()) continue;
            const std::int64_t width =
                slot.parameter.numel() / std::max<std::int64_t>(1, slot.parameter.size(0));
            std::int64_t rows = slot.parameter.size(0);
            at::Tensor row_index;  // undefined: all rows
            if (gradient.is_sparse()) {
                gradient = coalesce_rows(gradient);
                row_index = gradient._indices().select(0, 0).contiguous();
                gradient = gradient._values();
                rows = row_index.size(0);
            }
            gradient = gradient.contiguous();
            const at::Device device = slot.parameter.device();
            const at::Tensor own_rates = rates_on(rates, device);
            const AdamParameters p{
                row_index.defined() ? row_index.const_data_ptr<std::int64_t>() : nullptr,
                gradient.const_data_ptr<float>(),
                width,
                slot.parameter.data_ptr<float>(),
                slot.momentum.data_ptr<float>(),
                slot.variance.data_ptr<float>(),
                slot.updates.data_ptr<std::int32_t>(),
                group.options.row_factors.defined()
                    ? group.options.row_factors.const_data_ptr<float>()
                    : nullptr,
                static_cast<const AdamRates*>(own_rates.const_data_ptr())};
            if (device.is_cuda())
                cuda::run(cuda::field_table().adam_step, p, rows, device);
            else
                parallel_for(
                    "adam_step", rows, [=](std::int64_t i) { adam_step_row(p, i); }, 4096);
        }
    }
}

void Adam::zero_grad() {
    for (Group& group : groups_) {
        for (Slot& slot : group.slots)
            slot.parameter.mutable_grad() = at::Tensor();
    }
}

std::map<std::string, at::Tensor> Adam::state() const {
    std::map<std::string, at::Tensor> all;
    for (const Group& group : groups_) {
        for (std::size_t p = 0; p < group.slots.size(); ++p) {
            const Slot& slot = group.slots[p];
            const std::string prefix = group.name + "." + std::to_string(p) + ".";
            all[prefix + "momentum"] = slot.momentum;
            all[prefix + "variance"] = slot.variance;
            all[prefix + "updates"] = slot.updates;
        }
    }
    return all;
}

void Adam::load_state(const std::map<std::string, at::Tensor>& state) {
    for (auto& [name, own] : this->state()) {
        const auto found = state.find(name);
        ITEM3D_CHECK(found != state.end(), "optimiser state " + name + " is missing");
        ITEM3D_CHECK(found->second.sizes() == own.sizes(),
                     "optimiser state " + name + " has the wrong shape");
        at::Tensor target = own;
        target.copy_(found->second);
        if (target.scalar_type() == at::kInt && target.numel() > 0) {
            max_updates_ = std::max(max_updates_, target.max().item<int>());
        }
    }
}

}  // namespace item3d
