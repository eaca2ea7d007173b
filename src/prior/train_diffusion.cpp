#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/models/noise_schedule.h"
#include "item3d/models/safetensors.h"
#include "item3d/prior/export.h"
#include "item3d/prior/replicas.h"
#include "item3d/prior/train.h"
#include "item3d/prior/workers.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace item3d {
namespace {

using Clock = std::chrono::steady_clock;

/// One replica's networks.
struct Networks {
    UNet2DCondition unet{nullptr};
    ClipTextModel text{nullptr};
};

Networks make_networks(const TrainSettings& settings, const DiffusionConfig& config) {
    torch::manual_seed(static_cast<std::int64_t>(settings.seed) + 1);
    Networks networks{UNet2DCondition(config.unet), ClipTextModel(config.text)};
    // A small vocabulary learns sooner when its words start far apart.
    const torch::NoGradGuard no_grad;
    for (auto& item : networks.text->named_parameters()) {
        if (item.key().find("token_embedding") != std::string::npos) item.value().normal_(0, .3);
        if (item.key().find("position_embedding") != std::string::npos)
            item.value().normal_(0, .05);
    }
    return networks;
}

/// Rows of the data in the order of their epoch.
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

/// v-prediction loss on the pictures of one replica's batch. Everything random depends on
/// (seed, step, rank) alone.
torch::Tensor diffusion_loss(Networks& networks, const LatentData& data,
                             const NoiseSchedule& schedule, const std::vector<std::int64_t>& rows,
                             std::uint64_t seed, std::int64_t step, int rank) {
    const auto count = static_cast<std::int64_t>(rows.size());
    Random random(seed, 0xd1ff00 + static_cast<std::uint64_t>(rank),
                  static_cast<std::uint64_t>(step) * 4096);
    const torch::Tensor index = torch::tensor(rows);
    const torch::Tensor latents = data.latents.index_select(0, index).to(torch::kFloat32);
    torch::Tensor depth = data.depth.index_select(0, index).to(torch::kFloat32);
    torch::Tensor tokens = data.tokens.index_select(0, index).to(torch::kInt64);
    std::vector<std::int64_t> times;
    for (std::int64_t i = 0; i < count; ++i) {
        // Stratified: each batch covers the whole range of timesteps evenly.
        const double t = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
        times.push_back(std::min<std::int64_t>(999, static_cast<std::int64_t>(t * 1000)));
        if (random.chance(.15)) depth[i].zero_();
        if (random.chance(.10)) tokens[i].copy_(data.empty_tokens);
    }
    const torch::Tensor timesteps = torch::tensor(times);
    auto generator = at::detail::createCPUGenerator(random.bits());
    const torch::Tensor noise = torch::randn(latents.sizes(), generator);
    const torch::Tensor input =
        torch::cat({schedule.add_noise(latents, noise, timesteps), depth}, 1)
            .contiguous(torch::MemoryFormat::ChannelsLast);
    torch::Tensor prediction;
    {
        const Autocast autocast;
        const torch::Tensor text = networks.text->forward(tokens).last_hidden_state;
        prediction = networks.unet->forward(input, timesteps, text);
    }
    return (prediction.to(torch::kFloat32) - schedule.get_velocity(latents, noise, timesteps))
        .square()
        .mean();
}

/// Loss curve and clock of the run, kept in checkpoints.
struct Record {
    std::int64_t seen = 0;
    double seconds = 0;
    double loss = 1;  ///< mean of about the last 100 steps
};

class Trainer {
  public:
    Trainer(const LatentData& data, const TrainSettings& settings, const DiffusionConfig& config,
            const nlohmann::json& so_far)
        : data_(data), settings_(settings), so_far_(so_far) {
        std::vector<std::unique_ptr<FlatModel>> flat;
        for (int rank = 0; rank < settings_.replicas; ++rank) {
            networks_.push_back(make_networks(settings_, config));
            flat.push_back(
                std::make_unique<FlatModel>(std::vector<std::shared_ptr<torch::nn::Module>>{
                    networks_.back().unet.ptr(), networks_.back().text.ptr()}));
        }
        exported_ = make_networks(settings_, config);
        exported_flat_ =
            std::make_unique<FlatModel>(std::vector<std::shared_ptr<torch::nn::Module>>{
                exported_.unet.ptr(), exported_.text.ptr()});
        group_ = std::make_unique<ReplicaGroup>(std::move(flat), AdamOptions{});
        if (settings_.resume && std::filesystem::exists(checkpoint_file())) load_checkpoint();
    }

    nlohmann::json run() {
        note(fmt::format("prior: {:.2f} million parameters, {} replicas of {} pictures",
                         static_cast<double>(group_->replica(0).size()) / 1e6, settings_.replicas,
                         settings_.batch));
        started_ = saved_ = exported_at_ = Clock::now();
        const double seconds_before = record_.seconds;
        Progress progress("prior", settings_.samples, record_.seen);
        run_ranks(settings_.replicas, [&](int rank) {
            try {
                train(rank, progress, seconds_before);
            } catch (...) {
                group_->fail();
                throw;
            }
        });
        progress.finish();
        save_checkpoint();
        write_export();
        if (record_.seen < settings_.samples)
            throw Interrupted("the checkpoint is in " + settings_.work.string() +
                              "; the same command with --resume goes on");
        return summary();
    }

  private:
    std::filesystem::path checkpoint_file() const {
        return settings_.work / "checkpoint.safetensors";
    }

    void train(int rank, Progress& progress, double seconds_before) {
        Networks& networks = networks_[static_cast<std::size_t>(rank)];
        Shuffle shuffle(data_.latents.size(0), settings_.seed);
        const std::int64_t step_samples = std::int64_t{settings_.batch} * settings_.replicas;
        std::int64_t seen = record_.seen;
        for (std::int64_t step = group_->steps(); seen < settings_.samples; ++step) {
            std::vector<std::int64_t> rows;
            for (int i = 0; i < settings_.batch; ++i)
                rows.push_back(shuffle.row(seen + std::int64_t{rank} * settings_.batch + i));
            const torch::Tensor loss =
                diffusion_loss(networks, data_, schedule_, rows, settings_.seed, step, rank);
            loss.backward();
            const auto rate = static_cast<float>(settings_.learning_rate *
                                                 learning_rate_part(seen, settings_.samples));
            const double decay =
                std::min(.999, static_cast<double>(1 + step) / static_cast<double>(10 + step));
            const auto result = group_->step(
                rank, {rate, static_cast<float>(decay), should_stop(seen + step_samples)});
            seen += step_samples;
            if (rank == 0) {
                record_.seen = seen;
                record_.seconds = seconds_before + seconds_since(started_);
                const double now = loss.item<double>();
                record_.loss +=
                    (now - record_.loss) * std::max(.01, 1.0 / static_cast<double>(step + 1));
                progress.update(std::min(seen, settings_.samples),
                                fmt::format("loss {:.4f}  gradient {:.2f}  rate {:.1e}",
                                            record_.loss, result.gradient_norm, rate));
                // The other ranks cannot step before this one: what is read here stands still.
                if (seconds_since(saved_) > settings_.checkpoint_seconds) save_checkpoint();
                if (seconds_since(exported_at_) > settings_.export_seconds) write_export();
            }
            if (result.stop) break;
        }
    }

    bool should_stop(std::int64_t seen) const {
        return interrupted() || (settings_.stop_after > 0 && seen >= settings_.stop_after);
    }

    static double seconds_since(Clock::time_point start) {
        return std::chrono::duration<double>(Clock::now() - start).count();
    }

    nlohmann::json summary() const {
        nlohmann::json train = so_far_;
        train["samples"] = record_.seen;
        train["seconds"] = std::round(record_.seconds);
        train["loss"] = record_.loss;
        train["seed"] = settings_.seed;
        train["parameters"] = exported_flat_->size();
        return train;
    }

    void save_checkpoint() {
        NamedTensors tensors = group_->state();
        tensors.emplace_back("record", torch::tensor({static_cast<double>(record_.seen),
                                                      record_.seconds, record_.loss},
                                                     torch::kFloat64));
        save_safetensors(checkpoint_file(), tensors);
        saved_ = Clock::now();
    }

    void load_checkpoint() {
        const NamedTensors tensors = SafeTensors::open(checkpoint_file()).tensors();
        for (const auto& [name, tensor] : tensors) {
            if (name != "record" && name != "steps" && tensor.numel() != group_->replica(0).size())
                throw InputError(checkpoint_file().string(), "is of a network of another size",
                                 "train without --resume, or in another --work folder");
            if (name != "record") continue;
            record_.seen = static_cast<std::int64_t>(tensor[0].item<double>());
            record_.seconds = tensor[1].item<double>();
            record_.loss = tensor[2].item<double>();
        }
        group_->load_state(tensors);
        note("prior: goes on after " + std::to_string(record_.seen) + " pictures");
    }

    void write_export() {
        exported_flat_->values.copy_(group_->average());
        export_diffusion(settings_.output, exported_.unet, exported_.text, summary());
        exported_at_ = Clock::now();
    }

    const LatentData& data_;
    TrainSettings settings_;
    nlohmann::json so_far_;
    NoiseSchedule schedule_{SchedulerConfig::stable_diffusion("v_prediction")};
    std::vector<Networks> networks_;
    Networks exported_;
    std::unique_ptr<FlatModel> exported_flat_;
    std::unique_ptr<ReplicaGroup> group_;
    Record record_;
    Clock::time_point started_, saved_, exported_at_;
};

}  // namespace

double learning_rate_part(std::int64_t seen, std::int64_t total) {
    constexpr double rise = 6000, fall = .3, lowest = .02;
    const auto x = static_cast<double>(seen);
    const auto n = static_cast<double>(std::max<std::int64_t>(total, 1));
    const double up = std::min(1.0, (x + 64) / rise);
    const double down = std::clamp((n - x) / (fall * n), lowest, 1.0);
    return std::min(up, down);
}

UNet2DConditionConfig prior_unet_config() {
    UNet2DConditionConfig config;
    config.sample_size = latent_size;
    config.in_channels = 5;
    config.out_channels = 4;
    config.block_out_channels = {48, 96, 144};
    config.down_block_types.assign(3, "CrossAttnDownBlock2D");
    config.up_block_types.assign(3, "CrossAttnUpBlock2D");
    config.layers_per_block = {1, 1, 1};
    config.attention_head_dim = {2, 4, 6};
    config.transformer_layers_per_block = {1, 1, 1};
    config.cross_attention_dim.assign(3, 192);
    config.norm_num_groups = 16;
    return config;
}

ClipTextConfig prior_text_config(int vocabulary, int start_of_text, int end_of_text) {
    ClipTextConfig config;
    config.vocab_size = vocabulary;
    config.hidden_size = 192;
    config.intermediate_size = 768;
    config.num_hidden_layers = 3;
    config.num_attention_heads = 3;
    config.max_position_embeddings = text_length;
    config.bos_token_id = start_of_text;
    config.eos_token_id = end_of_text;
    config.pad_token_id = end_of_text;
    config.projection_dim = 192;
    return config;
}

nlohmann::json train_diffusion(const LatentData& data, const TrainSettings& settings,
                               const DiffusionConfig& networks, const nlohmann::json& so_far) {
    return Trainer(data, settings, networks, so_far).run();
}

}  // namespace item3d
