#include "item3d/prior/training/replicas.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/prior/training/muon.h"
#include "item3d/tensors/precision.h"

#include <ATen/autocast_mode.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Returns a view of `flat` from `offset` on with the shape of `like`; a four-dimensional view is
/// channels-last.
at::Tensor view_of(const at::Tensor& flat, std::int64_t offset, const at::Tensor& like) {
    const auto part = flat.narrow(0, offset, like.numel());
    if (like.dim() != 4) return part.view(like.sizes());
    const auto s = like.sizes();
    return part.view({s[0], s[2], s[3], s[1]}).permute({0, 3, 1, 2});
}

/// Number of values in a block of a sum of squares. Sums that are formed by block do not depend on
/// the number of ranks.
constexpr std::int64_t block_size = 4096;

std::int64_t block_count(std::int64_t total) {
    return (total + block_size - 1) / block_size;
}

constexpr std::int64_t smallest_matrix = 16;

bool is_hidden_matrix(const std::string& name, const at::Tensor& parameter) {
    return parameter.dim() >= 2 && parameter.size(0) >= smallest_matrix &&
           parameter.numel() / parameter.size(0) >= smallest_matrix &&
           name.find("embedding") == std::string::npos && name.find("conv_in") == std::string::npos;
}

}  // namespace

FlatModel::FlatModel(const std::vector<std::shared_ptr<torch::nn::Module>>& modules) {
    std::int64_t total = 0;
    for (const auto& module : modules) {
        for (const auto& item : module->named_parameters()) {
            const at::Tensor& parameter = item.value();
            parameters_.push_back(parameter);
            if (is_hidden_matrix(item.key(), parameter))
                matrices_.push_back(
                    {total, parameter.size(0), parameter.numel() / parameter.size(0)});
            total += parameter.numel();
        }
    }
    ITEM3D_CHECK(!parameters_.empty(), "a model needs parameters");
    const at::Device device = parameters_.front().device();
    values = at::zeros({total}, device);
    gradients = at::zeros({total}, device);
    const at::NoGradGuard no_grad;
    std::int64_t offset = 0;
    for (at::Tensor& parameter : parameters_) {
        view_of(values, offset, parameter).copy_(parameter);
        parameter.mutable_grad() = view_of(gradients, offset, parameter);
        offset += parameter.numel();
    }
    use_values(values);
}

void FlatModel::use_values(const at::Tensor& other) {
    ITEM3D_CHECK(other.numel() == gradients.numel(), "another model's parameters");
    std::int64_t offset = 0;
    for (at::Tensor& parameter : parameters_) {
        parameter.set_data(view_of(other, offset, parameter));
        offset += parameter.numel();
    }
}

ReplicaGroup::ReplicaGroup(std::vector<std::unique_ptr<FlatModel>> replicas,
                           const OptimizerOptions& options, ProcessGroup processes)
    : replicas_(std::move(replicas)),
      options_(options),
      processes_(std::move(processes)),
      barrier_(static_cast<std::ptrdiff_t>(replicas_.size())) {
    ITEM3D_CHECK(!replicas_.empty(), "a group needs a replica");
    const at::Tensor& values = replicas_[0]->values;
    ITEM3D_CHECK(values.is_cpu() || replicas_.size() == 1, "a device trains one replica");
    for (auto& replica : replicas_)
        replica->values.copy_(values);
    first_moment_ = at::zeros_like(values);
    second_moment_ = at::zeros_like(values);
    average_ = values.clone();
    changes_ = at::zeros_like(values);
    sum_ = at::zeros({values.numel() + 1}, values.options());
    square_sums_.resize(static_cast<std::size_t>(block_count(values.numel())));
}

void ReplicaGroup::wait() {
    barrier_.arrive_and_wait();
    if (!failed_) return;
    const std::lock_guard lock(failure_mutex_);
    std::rethrow_exception(failure_);
}

void ReplicaGroup::fail() {
    {
        const std::lock_guard lock(failure_mutex_);
        if (!failure_) failure_ = std::current_exception();
    }
    failed_ = true;
    barrier_.arrive_and_drop();
}

ReplicaGroup::Result ReplicaGroup::step_on_device(const Request& request) {
    const at::NoGradGuard no_grad;
    FlatModel& model = *replicas_[0];
    const std::int64_t total = model.size();
    sum_.narrow(0, 0, total).copy_(model.gradients);
    bool stop = request.stop;
    if (processes_.size() > 1) {
        sum_[total].fill_(stop ? 1 : 0);
        at::Tensor sum = sum_.cpu();
        processes_.sum(sum);
        stop = sum[total].item<float>() > 0;
        sum_.copy_(sum);
    }
    const at::Tensor gradient = sum_.narrow(0, 0, total);
    gradient.mul_(1.0 / processes_.size());
    const auto norm = gradient.norm().item<float>();
    if (!std::isfinite(norm)) {
        model.gradients.zero_();
        end_step(false);
        return {norm, stop};
    }
    const float clip = norm > options_.clip_norm ? options_.clip_norm / norm : 1.0f;
    gradient.mul_(clip);
    first_moment_.lerp_(gradient, 1 - options_.beta1);
    second_moment_.mul_(options_.beta2).addcmul_(gradient, gradient, 1 - options_.beta2);
    const auto time = static_cast<double>(steps_ + 1);
    const double correction1 = 1 - std::pow(double{options_.beta1}, time);
    const double correction2 = 1 - std::pow(double{options_.beta2}, time);
    changes_.copy_(first_moment_ / correction1 /
                   (second_moment_ / correction2).sqrt_().add_(options_.epsilon));
    if (options_.orthogonal) orthogonalize(0, 1);
    model.values.sub_((changes_ + model.values * options_.weight_decay) * request.learning_rate);
    average_.lerp_(model.values, 1 - request.ema_decay);
    model.gradients.zero_();
    end_step(true);
    return {norm, stop};
}

void ReplicaGroup::end_step(bool succeeded) {
    // A skipped step counts too, because the random numbers of a resumed training begin there.
    ++steps_;
    if (failed_steps_.too_many_after(!succeeded))
        throw InputError("training",
                         fmt::format("the gradients of {} steps in a row are not finite numbers",
                                     failed_steps_.limit()),
                         "use a smaller --learning-rate");
}

ReplicaGroup::Result ReplicaGroup::step(int rank, const Request& request) {
    if (!sum_.is_cpu()) return step_on_device(request);
    const std::int64_t ranks = size();
    const std::int64_t total = replicas_[0]->size(), blocks = block_count(total);
    // Each rank handles some blocks of the vector.
    const std::int64_t first_block = blocks * rank / ranks, end_block = blocks * (rank + 1) / ranks;
    const std::int64_t begin = std::min(total, first_block * block_size);
    const std::int64_t end = std::min(total, end_block * block_size);
    wait();

    auto* sum = sum_.data_ptr<float>();
    const auto* first = replicas_[0]->gradients.data_ptr<float>();
    std::copy(first + begin, first + end, sum + begin);
    for (std::int64_t other = 1; other < ranks; ++other) {
        const auto* from = replicas_[static_cast<std::size_t>(other)]->gradients.data_ptr<float>();
        for (std::int64_t i = begin; i < end; ++i)
            sum[i] += from[i];
    }
    if (rank == 0) sum[total] = request.stop ? 1.0f : 0.0f;
    wait();
    if (processes_.size() > 1) {
        if (rank == 0) processes_.sum(sum_);
        wait();
    }

    const float share = 1.0f / static_cast<float>(ranks * processes_.size());
    for (std::int64_t block = first_block; block < end_block; ++block) {
        double squares = 0;
        const std::int64_t block_end = std::min(total, (block + 1) * block_size);
        for (std::int64_t i = block * block_size; i < block_end; ++i) {
            sum[i] *= share;
            squares += static_cast<double>(sum[i]) * sum[i];
        }
        square_sums_[static_cast<std::size_t>(block)] = squares;
    }
    wait();

    double all_squares = 0;
    for (const double each : square_sums_)
        all_squares += each;
    const auto norm = static_cast<float>(std::sqrt(all_squares));
    const bool stop = sum[total] > 0;
    if (!std::isfinite(norm)) {
        for (auto& replica : replicas_)
            std::fill_n(replica->gradients.data_ptr<float>() + begin, end - begin, 0.0f);
        wait();
        if (rank == 0) end_step(false);
        return {norm, stop};
    }
    const float clip = norm > options_.clip_norm ? options_.clip_norm / norm : 1.0f;
    const auto time = static_cast<double>(steps_ + 1);
    const auto correction1 = static_cast<float>(1 / (1 - std::pow(double{options_.beta1}, time)));
    const auto correction2 = static_cast<float>(1 / (1 - std::pow(double{options_.beta2}, time)));
    auto* values = replicas_[0]->values.data_ptr<float>();
    auto* m = first_moment_.data_ptr<float>();
    auto* v = second_moment_.data_ptr<float>();
    auto* average = average_.data_ptr<float>();
    auto* change = changes_.data_ptr<float>();
    for (std::int64_t i = begin; i < end; ++i) {
        const float gradient = sum[i] * clip;
        m[i] = options_.beta1 * m[i] + (1 - options_.beta1) * gradient;
        v[i] = options_.beta2 * v[i] + (1 - options_.beta2) * gradient * gradient;
        change[i] = m[i] * correction1 / (std::sqrt(v[i] * correction2) + options_.epsilon);
    }
    if (options_.orthogonal) {
        wait();
        orthogonalize(rank, clip);
        wait();
    }
    for (std::int64_t i = begin; i < end; ++i) {
        values[i] -= request.learning_rate * (change[i] + options_.weight_decay * values[i]);
        average[i] += (1 - request.ema_decay) * (values[i] - average[i]);
    }
    for (auto& replica : replicas_) {
        if (replica != replicas_[0])
            std::copy(values + begin, values + end, replica->values.data_ptr<float>() + begin);
        std::fill_n(replica->gradients.data_ptr<float>() + begin, end - begin, 0.0f);
    }
    wait();
    if (rank == 0) end_step(true);  // other ranks read the number only after the next wait
    return {norm, stop};
}

void ReplicaGroup::orthogonalize(int rank, float clip) {
    const auto& matrices = replicas_[0]->matrices();
    for (auto i = static_cast<std::size_t>(rank); i < matrices.size();
         i += static_cast<std::size_t>(size())) {
        const FlatModel::Matrix& matrix = matrices[i];
        const auto part = [&](const at::Tensor& all) {
            return all.narrow(0, matrix.offset, matrix.rows * matrix.columns)
                .view({matrix.rows, matrix.columns});
        };
        // Nesterov's momentum: the newest gradient is added once more.
        const at::Tensor momentum =
            part(first_moment_) * options_.beta1 + part(sum_) * (clip * (1 - options_.beta1));
        part(changes_).copy_(newton_schulz(momentum) *
                             orthogonal_step_scale(matrix.rows, matrix.columns));
    }
}

std::vector<std::pair<std::string, at::Tensor>> ReplicaGroup::state() const {
    return {{"values", replicas_[0]->values.cpu()},
            {"average", average_.cpu()},
            {"first_moment", first_moment_.cpu()},
            {"second_moment", second_moment_.cpu()},
            {"steps", at::tensor({steps_}, at::kLong)}};
}

void ReplicaGroup::load_state(const std::vector<std::pair<std::string, at::Tensor>>& state) {
    const at::NoGradGuard no_grad;
    for (const auto& [name, tensor] : state) {
        if (name == "steps") {
            steps_ = tensor.item<std::int64_t>();
            continue;
        }
        const bool ours = name == "average" || name == "first_moment" || name == "second_moment" ||
                          name == "values";
        if (!ours) continue;  // skips tensors of the caller in the same checkpoint
        ITEM3D_CHECK(tensor.numel() == average_.numel(), "the state of another model: " + name);
        if (name == "average") average_.copy_(tensor);
        if (name == "first_moment") first_moment_.copy_(tensor);
        if (name == "second_moment") second_moment_.copy_(tensor);
        if (name == "values")
            for (auto& replica : replicas_)
                replica->values.copy_(tensor);
    }
}

Autocast::Autocast(at::Device device)
    : device_(device.type()),
      enabled_before_(at::autocast::is_autocast_enabled(device_)),
      cache_before_(at::autocast::is_autocast_cache_enabled()) {
    const at::ScalarType precision = choose_precision("auto", device);
    at::autocast::set_autocast_enabled(device_, precision != at::kFloat);
    at::autocast::set_autocast_dtype(device_, at::kBFloat16);
    // Disables the cache of converted weights, which all threads would share. Each weight is used
    // only once, so the cache would not help.
    at::autocast::set_autocast_cache_enabled(false);
}

Autocast::~Autocast() {
    at::autocast::set_autocast_enabled(device_, enabled_before_);
    at::autocast::set_autocast_cache_enabled(cache_before_);
}

}  // namespace item3d
