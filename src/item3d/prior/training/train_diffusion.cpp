#include "item3d/prior/training/train_diffusion.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/random.h"
#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/training/export.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/prior/training/training_loop.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Fraction of the training images whose shape condition is left out. With 15 %, a network with the
/// surface condition learnt little about appearance.
constexpr double without_shape = 0.30;
/// Fraction of the training images whose sentence is left out.
constexpr double without_sentence = 0.10;

/// Networks of one replica.
struct Networks {
    UNet2DCondition unet{nullptr};
    ClipTextModel text{nullptr};

    std::vector<std::shared_ptr<torch::nn::Module>> modules() const {
        return {unet.ptr(), text.ptr()};
    }
};

Networks make_networks(const TrainSettings& settings, const DiffusionConfig& config) {
    at::manual_seed(static_cast<std::int64_t>(settings.seed) + 1);
    Networks networks{UNet2DCondition(config.unet), ClipTextModel(config.text)};
    // A small vocabulary is learnt sooner if its embeddings start far apart.
    const at::NoGradGuard no_grad;
    for (auto& item : networks.text->named_parameters()) {
        if (item.key().find("token_embedding") != std::string::npos) item.value().normal_(0, .3);
        if (item.key().find("position_embedding") != std::string::npos)
            item.value().normal_(0, .05);
    }
    return networks;
}

/// Returns weights [N, 1, h, w]: the object counts four times as much as the background, which
/// captions do not describe. depth: depth_condition(), -1 for background.
at::Tensor object_weights(const at::Tensor& depth) {
    const at::Tensor covered = ((depth + 1) / 1.2).clamp(0, 1);
    const at::Tensor weights = covered * 3 + 1;
    return weights / weights.mean();
}

/// Returns the denoising loss of one replica's batch. All randomness depends on (seed, step, rank)
/// alone.
at::Tensor diffusion_loss(Networks networks, const LatentData& data, const NoiseSchedule& schedule,
                          const std::vector<std::int64_t>& rows, std::uint64_t seed,
                          std::int64_t step, int rank) {
    const auto count = static_cast<std::int64_t>(rows.size());
    Random random(seed, 0xd1ff00 + static_cast<std::uint64_t>(rank),
                  static_cast<std::uint64_t>(step) * 4096);
    const at::Tensor index = at::tensor(rows);
    const at::Tensor latents = data.latents.index_select(0, index).to(at::kFloat);
    const at::Tensor cells = data.cells.index_select(0, index).to(at::kFloat);
    const at::Tensor weights = object_weights(cells.slice(1, 0, 1));
    const auto more = static_cast<int>(networks.unet->config().in_channels - latents.size(1));
    at::Tensor condition = data.sources.defined()
                               ? data.sources.index_select(0, index).to(at::kFloat)
                               : shape_condition(cells, more);
    at::Tensor tokens = data.tokens.index_select(0, index).to(at::kLong);
    std::vector<std::int64_t> times;
    for (std::int64_t i = 0; i < count; ++i) {
        // Timesteps are stratified: each batch covers their range evenly.
        const double t = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
        times.push_back(std::min<std::int64_t>(999, static_cast<std::int64_t>(t * 1000)));
        if (random.chance(without_shape) && more > 0) condition[i].zero_();
        if (random.chance(without_sentence)) tokens[i].copy_(data.empty_tokens);
    }
    const at::Tensor timesteps = at::tensor(times);
    auto generator = at::detail::createCPUGenerator(random.bits());
    const at::Tensor noise = at::randn(latents.sizes(), generator);
    at::Tensor input = schedule.add_noise(latents, noise, timesteps);
    if (more > 0) input = at::cat({input, condition}, 1);
    const at::Device device = networks.unet->parameters().front().device();
    input = input.to(device).contiguous(at::MemoryFormat::ChannelsLast);
    at::Tensor prediction;
    {
        const Autocast autocast(device);
        const at::Tensor text = networks.text->forward(tokens.to(device)).last_hidden_state;
        prediction = networks.unet->forward(input, timesteps.to(device), text);
    }
    const at::Tensor wanted =
        schedule.predicts_velocity() ? schedule.get_velocity(latents, noise, timesteps) : noise;
    return ((prediction.to(at::kFloat) - wanted.to(device)).square() * weights.to(device)).mean();
}

}  // namespace

namespace {

/// Returns the number of attention heads. The number of channels of a head is the first of 24, 32
/// and 16 that divides the width.
int heads_of(int width) {
    for (const int channels : {24, 32, 16})
        if (width % channels == 0) return width / channels;
    ITEM3D_CHECK(false, "widths must be multiples of 16");
    return 1;
}

int condition_channels_of(const std::string& condition) {
    if (condition == "none") return 0;
    if (condition == "depth") return 1;
    if (condition == image_condition) return latent_channels;
    ITEM3D_CHECK(condition == "surface",
                 "the condition of a U-Net must be surface, depth, picture or none");
    return surface_condition_channels;
}

}  // namespace

NamedTensors LatentData::tensors() const {
    NamedTensors all{
        {"latents", latents}, {"cells", cells}, {"tokens", tokens}, {"empty_tokens", empty_tokens}};
    if (sources.defined()) all.emplace_back("sources", sources);
    return all;
}

LatentData LatentData::from_tensors(const NamedTensors& tensors, std::size_t vocabulary,
                                    const std::filesystem::path& file) {
    const std::string hint = "train without --resume, or in another --work folder";
    const auto take = [&](const char* wanted, at::ScalarType dtype) {
        for (const auto& [name, tensor] : tensors)
            if (name == wanted && tensor.scalar_type() == dtype) return tensor;
        throw InputError(file.string(), fmt::format("has no '{}' of the right type", wanted), hint);
    };
    LatentData data{take("latents", at::kHalf),
                    take("cells", at::kHalf),
                    take("tokens", at::kShort),
                    take("empty_tokens", at::kShort),
                    {}};
    if (std::any_of(tensors.begin(), tensors.end(),
                    [](const auto& each) { return each.first == "sources"; }))
        data.sources = take("sources", at::kHalf);
    const std::int64_t rows = data.latents.dim() > 0 ? data.latents.size(0) : 0;
    const auto has = [](const at::Tensor& tensor, const std::vector<std::int64_t>& shape) {
        return tensor.sizes().vec() == shape;
    };
    if (rows == 0 || !has(data.latents, {rows, latent_channels, latent_size, latent_size}) ||
        !has(data.cells, {rows, shape_cell_channels, latent_size, latent_size}) ||
        !has(data.tokens, {rows, text_length}) || !has(data.empty_tokens, {text_length}) ||
        (data.sources.defined() && data.sources.sizes() != data.latents.sizes()))
        throw InputError(file.string(), "its tensors have unexpected shapes", hint);
    const auto lowest = std::min(data.tokens.min().item<std::int16_t>(),
                                 data.empty_tokens.min().item<std::int16_t>());
    const auto highest = std::max(data.tokens.max().item<std::int16_t>(),
                                  data.empty_tokens.max().item<std::int16_t>());
    if (lowest < 0 || static_cast<std::size_t>(highest) >= vocabulary)
        throw InputError(file.string(),
                         fmt::format("has tokens from {} to {}, but the tokenizer has {}", lowest,
                                     highest, vocabulary),
                         hint);
    return data;
}

UNet2DConditionConfig prior_unet_config(const TrainSettings& settings) {
    const std::vector<int>& widths = settings.widths;
    UNet2DConditionConfig config;
    config.sample_size = latent_size;
    config.in_channels = latent_channels + condition_channels_of(settings.condition);
    config.out_channels = latent_channels;
    const std::size_t levels = widths.size();
    config.block_out_channels = widths;
    config.down_block_types.assign(levels, "CrossAttnDownBlock2D");
    config.up_block_types.assign(levels, "CrossAttnUpBlock2D");
    config.layers_per_block.assign(levels, 1);
    config.attention_head_dim.clear();
    for (const int width : widths)
        config.attention_head_dim.push_back(heads_of(width));
    config.transformer_layers_per_block.assign(levels, 1);
    config.cross_attention_dim.assign(levels, 192);
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
                               const DiffusionConfig& config, const nlohmann::json& so_far) {
    const SchedulerConfig scheduler = SchedulerConfig::stable_diffusion(settings.prediction_type);
    const NoiseSchedule schedule(scheduler);
    std::vector<LoopReplica> replicas;
    for (int rank = 0; rank < settings.replicas; ++rank) {
        Networks networks = make_networks(settings, config);
        // The loop copies the first replica's values to all others.
        if (rank == 0 && settings.processes.first() && !settings.init_from.empty())
            init_from_weights(settings.init_from, networks.unet, networks.text,
                              data.sources.defined());
        for (const auto& module : networks.modules())
            module->to(settings.device);
        const int stream = global_rank(settings, rank);
        replicas.push_back({networks.modules(), [&, networks, stream](const auto& rows, auto step) {
                                return diffusion_loss(networks, data, schedule, rows, settings.seed,
                                                      step, stream);
                            }});
    }
    LoopOptions options = loop_options(settings, "prior", "checkpoint.safetensors");
    options.samples = settings.samples;
    options.rows = data.latents.size(0);
    options.batch = settings.batch;
    options.objective = settings.prediction_type;
    options.orthogonal = settings.optimizer == "muon";
    TrainingLoop loop(options, std::move(replicas));

    const Networks exported = make_networks(settings, config);
    FlatModel flat(exported.modules());
    nlohmann::json train = so_far;
    loop.run([&](const at::Tensor& average, const LoopRecord& record) {
        flat.values.copy_(average);
        train["samples"] = record.seen;
        train["seconds"] = std::round(record.seconds);
        train["loss"] = record.loss;
        train["seed"] = settings.seed;
        train["resolution"] = settings.resolution;
        train["parameters"] = loop.parameters();
        export_diffusion(settings.output, exported.unet, exported.text, scheduler,
                         settings.resolution, train);
    });
    return train;
}

}  // namespace item3d
