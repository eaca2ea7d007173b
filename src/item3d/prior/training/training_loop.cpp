#include "item3d/prior/training/training_loop.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace item3d {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Random order of the training samples; each epoch has a new one.
class Shuffle {
  public:
    Shuffle(std::int64_t count, std::uint64_t seed) : count_(count), seed_(seed) {}
    std::int64_t row(std::int64_t position) {
        const std::int64_t epoch = position / count_;
        if (epoch != epoch_) {
            epoch_ = epoch;
            order_.resize(static_cast<std::size_t>(count_));
            for (std::int64_t i = 0; i < count_; ++i)
                order_[static_cast<std::size_t>(i)] = i;
            Random random(seed_, 0x5f0000 + static_cast<std::uint64_t>(epoch));
            for (std::int64_t i = count_ - 1; i > 0; --i)
                std::swap(order_[static_cast<std::size_t>(i)],
                          order_[static_cast<std::size_t>(random.index(i + 1))]);
        }
        return order_[static_cast<std::size_t>(position % count_)];
    }

  private:
    std::int64_t count_;
    std::uint64_t seed_;
    std::int64_t epoch_ = -1;
    std::vector<std::int64_t> order_;
};

}  // namespace

LoopOptions loop_options(const TrainSettings& settings, const std::string& label,
                         const std::string& checkpoint) {
    LoopOptions options;
    options.label = label;
    options.checkpoint = settings.work / checkpoint;
    options.learning_rate = settings.learning_rate;
    options.seed = settings.seed;
    options.resume = settings.resume;
    options.stop_after = settings.stop_after;
    options.checkpoint_seconds = settings.checkpoint_seconds;
    options.export_seconds = settings.export_seconds;
    options.processes = settings.processes;
    return options;
}

TrainingLoop::TrainingLoop(const LoopOptions& options, std::vector<LoopReplica> replicas)
    : options_(options), replicas_(std::move(replicas)) {
    ITEM3D_CHECK(options_.rows > 0, "there is no training data");
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (const LoopReplica& replica : replicas_)
        flat.push_back(std::make_unique<FlatModel>(replica.modules));
    const ProcessGroup& processes = options_.processes;
    group_ = std::make_unique<ReplicaGroup>(
        std::move(flat), OptimizerOptions{.orthogonal = options_.orthogonal}, processes);
    if (processes.first() && options_.resume && std::filesystem::exists(options_.checkpoint))
        load_checkpoint();
    if (processes.size() > 1) load_state(processes.broadcast(state()));
}

void TrainingLoop::run(const Export& write_export) {
    const ProcessGroup& processes = options_.processes;
    const bool first = processes.first();
    if (first)
        note(fmt::format("{}: {:.2f} million parameters, {} replicas with {} images each",
                         options_.label, static_cast<double>(parameters()) / 1e6,
                         group_->size() * processes.size(), options_.batch));
    try {
        run_ranks(group_->size(), [&](int rank) {
            try {
                train(rank, write_export);
            } catch (...) {
                group_->fail();
                throw;
            }
        });
    } catch (const Error& error) {
        // If other processes are gone, process 0 still saves the state of the last complete step.
        const bool alone = dynamic_cast<const LostProcess*>(&error) != nullptr ||
                           error.code() == ExitCode::interrupted;
        if (first && alone) save_checkpoint();
        throw;
    }
    if (first) {
        save_checkpoint();
        write_export(group_->average(), record_);
    }
    processes.barrier();  // torchrun would end the others when the first process ends
    if (record_.seen < options_.samples)
        throw Interrupted("the checkpoint is " + options_.checkpoint.string() +
                          "; run the same command with --resume to continue");
}

void TrainingLoop::train(int rank, const Export& write_export) {
    const Clock::time_point started = Clock::now();
    Clock::time_point saved = started, exported = started;
    const double seconds_before = record_.seconds;
    Shuffle shuffle(options_.rows, options_.seed);
    const ProcessGroup& processes = options_.processes;
    const int global_rank = processes.rank() * group_->size() + rank;
    const std::int64_t step_samples =
        std::int64_t{options_.batch} * group_->size() * processes.size();
    std::int64_t seen = record_.seen;
    std::unique_ptr<Progress> progress;
    if (global_rank == 0)
        progress = std::make_unique<Progress>(options_.label, options_.samples, seen);
    for (std::int64_t step = group_->steps(); seen < options_.samples; ++step) {
        std::vector<std::int64_t> rows;
        for (int i = 0; i < options_.batch; ++i)
            rows.push_back(shuffle.row(seen + std::int64_t{global_rank} * options_.batch + i));
        const at::Tensor loss = replicas_[static_cast<std::size_t>(rank)].loss(rows, step);
        loss.backward();
        const auto rate = static_cast<float>(
            options_.learning_rate * learning_rate_part(seen, options_.samples, options_.rise));
        const double decay =
            std::min(.999, static_cast<double>(1 + step) / static_cast<double>(10 + step));
        const auto result =
            group_->step(rank, {rate, static_cast<float>(decay), should_stop(seen + step_samples)});
        seen += step_samples;
        if (rank == 0) record_.seen = seen;
        if (global_rank == 0) {
            record_.seconds = seconds_before + seconds_since(started);
            const double now = loss.item<double>();
            if (std::isfinite(now))
                record_.loss +=
                    (now - record_.loss) * std::max(.01, 1.0 / static_cast<double>(step + 1));
            progress->update(std::min(seen, options_.samples),
                             fmt::format("loss {:.4f}  gradient {:.2f}  rate {:.1e}", record_.loss,
                                         result.gradient_norm, rate));
            // The other ranks cannot step before this one, so what is read here is stable.
            if (seconds_since(saved) > options_.checkpoint_seconds) {
                save_checkpoint();
                saved = Clock::now();
            }
            if (seconds_since(exported) > options_.export_seconds) {
                write_export(group_->average(), record_);
                exported = Clock::now();
            }
        }
        if (result.stop) break;
    }
}

bool TrainingLoop::should_stop(std::int64_t seen) const {
    return interrupted() || (options_.stop_after > 0 && seen >= options_.stop_after);
}

NamedTensors TrainingLoop::state() const {
    NamedTensors tensors = group_->state();
    tensors.emplace_back(
        "record", at::tensor({static_cast<double>(record_.seen), record_.seconds, record_.loss},
                             at::kDouble));
    return tensors;
}

void TrainingLoop::load_state(const NamedTensors& state) {
    group_->load_state(state);
    for (const auto& [name, tensor] : state) {
        if (name != "record") continue;
        record_.seen = static_cast<std::int64_t>(tensor[0].item<double>());
        record_.seconds = tensor[1].item<double>();
        record_.loss = tensor[2].item<double>();
    }
}

/// Returns the settings that a resumed training must share. The number of samples is not among
/// them, because learning_rate_part() permits a larger one.
nlohmann::json TrainingLoop::checkpoint_settings() const {
    std::string network;
    for (const auto& module : replicas_[0].modules)
        for (const auto& item : module->named_parameters())
            network +=
                fmt::format("{} {};", item.key(), fmt::join(item.value().sizes().vec(), "x"));
    std::uint64_t hash = 0;
    for (const char letter : network)
        hash = mix_bits(hash ^ static_cast<std::uint8_t>(letter));
    return {{"network", fmt::format("{} parameters ({:016x})", parameters(), hash)},
            {"rows", options_.rows},
            {"batch", options_.batch},
            {"objective", options_.objective},
            {"optimizer", options_.orthogonal ? "muon" : "adamw"},
            {"replicas", group_->size() * options_.processes.size()},
            {"learning_rate", as_written(options_.learning_rate)},
            {"seed", options_.seed}};
}

void TrainingLoop::save_checkpoint() const {
    save_safetensors(options_.checkpoint, state(), {{"settings", checkpoint_settings().dump()}});
}

void TrainingLoop::load_checkpoint() {
    const SafeTensors file = SafeTensors::open(options_.checkpoint);
    if (file.metadata().count("settings"))  // older checkpoints lack the settings
        check_settings(options_.checkpoint, parse_json(file.metadata().at("settings")),
                       checkpoint_settings());
    for (const auto& [name, tensor] : state()) {
        const TensorInfo info = file.info(name);
        if (info.dtype != tensor.scalar_type() || info.shape != tensor.sizes().vec())
            throw InputError(
                options_.checkpoint.string(),
                fmt::format("is for another network: '{}' has {} numbers instead of {}", name,
                            file.tensor(name).numel(), tensor.numel()),
                "train without --resume, or in another --work folder");
    }
    load_state(file.tensors());
    note(fmt::format("{}: resuming after {} images", options_.label, record_.seen));
}

double learning_rate_part(std::int64_t seen, std::int64_t total, double rise) {
    constexpr double fall = .3, lowest = .02;
    const auto x = static_cast<double>(seen);
    const auto n = static_cast<double>(std::max<std::int64_t>(total, 1));
    const double up = std::min(1.0, (x + 64) / rise);
    const double down = std::clamp((n - x) / (fall * n), lowest, 1.0);
    return std::min(up, down);
}

}  // namespace item3d
