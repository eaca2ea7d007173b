#include "item3d/prior/training/train_autoencoder.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/weights.h"
#include "item3d/tensors/workers.h"

#include <cmath>

namespace item3d {
namespace {

constexpr int batch = 8;
constexpr float highest_rate = 1.5e-3f;

struct Batch {
    at::Tensor images;   ///< [N, 3, S, S] in [-1, 1], channels-last
    at::Tensor weights;  ///< [N, 1, S, S], about 1 on average
};

Batch gather(const ImageData& data, const at::Tensor& rows) {
    Batch result;
    result.images =
        data.images.index_select(0, rows).permute({0, 3, 1, 2}).to(at::kFloat).div(127.5).sub(1);
    // Object pixels get larger weights, because edits concern the object and a plain background is
    // easy.
    result.weights =
        data.covered.index_select(0, rows).unsqueeze(1).to(at::kFloat).mul(1.3 / 255).add(.45);
    return result;
}

at::Tensor differences(const at::Tensor& error, const at::Tensor& weights) {
    const auto across = error.slice(3, 1) - error.slice(3, 0, -1);
    const auto down = error.slice(2, 1) - error.slice(2, 0, -1);
    return (across.abs() * weights.slice(3, 1)).mean() + (down.abs() * weights.slice(2, 1)).mean();
}

constexpr int anchored = 3;

/// Returns the squared deviation of the variance from 0.5, for all latent channels but the first
/// three. Smaller variances are lost in the noise of most timesteps.
at::Tensor spread_loss(const at::Tensor& latents) {
    return (latents.slice(1, anchored).var({0, 2, 3}, false) - .5).square().mean();
}

/// Returns the loss at `progress`, 0 .. 1. Its anchor term ties the first three latent channels to
/// the downscaled image. Without this term, training takes several times longer.
at::Tensor reconstruction_loss(AutoencoderTiny& model, const Batch& data, double progress,
                               const at::Tensor& noise) {
    at::Tensor latents, images;
    {
        const Autocast autocast(at::kCPU);
        latents = model.encode(data.images);
        images = model.decode(latents + noise * .05);
    }
    const at::Tensor error = images.to(at::kFloat) - data.images;
    latents = latents.to(at::kFloat);
    const at::Tensor anchor =
        (latents.slice(1, 0, anchored) -
         1.5 * at::avg_pool2d(data.images, data.images.size(2) / latents.size(2)))
            .square()
            .mean();
    const double anchor_weight = .02 + .98 * std::max(0.0, 1 - 4 * progress);
    return (error.abs() * data.weights).mean() + (error.square() * data.weights).mean() +
           .5 * differences(error, data.weights) + 1e-4 * .5 * latents.square().mean() +
           anchor_weight * anchor + .05 * spread_loss(latents);
}

std::shared_ptr<AutoencoderTiny> make_model(const TrainSettings& settings) {
    at::manual_seed(static_cast<std::int64_t>(settings.seed));
    auto model = std::make_shared<AutoencoderTiny>(prior_autoencoder_config(settings.resolution));
    return model;
}

/// Measures the held-out error and sets the scaling factor.
TrainedAutoencoder finish(std::shared_ptr<AutoencoderTiny> model, const ImageData& held_out) {
    const at::NoGradGuard no_grad;
    double squares = 0, object_squares = 0, object_weight = 0;
    std::vector<at::Tensor> latents;
    for (std::int64_t i = 0; i < held_out.images.size(0); i += 32) {
        const auto end = std::min(i + 32, held_out.images.size(0));
        const Batch data = gather(held_out, at::arange(i, end));
        const at::Tensor z = model->encode(data.images);
        const at::Tensor error = (model->decode(z).clamp(-1, 1) - data.images).square();
        const at::Tensor object =
            held_out.covered.slice(0, i, end).unsqueeze(1).to(at::kFloat) / 255;
        squares += error.mean({1, 2, 3}).sum().item<double>();
        object_squares += (error * object).sum().item<double>() / 3;
        object_weight += object.sum().item<double>();
        latents.push_back(z);
    }
    model->set_scaling_factor(1 / at::cat(latents).std().item<double>());
    const double mean = squares / static_cast<double>(held_out.images.size(0));
    return {model, 10 * std::log10(4 / mean), 10 * std::log10(4 * object_weight / object_squares)};
}

}  // namespace

AutoencoderTinyConfig prior_autoencoder_config(int resolution) {
    AutoencoderTinyConfig config;
    config.latent_channels = latent_channels;
    config.num_encoder_blocks = {1, 2, 3};
    config.num_decoder_blocks = {3, 2, 1};
    // Each further level halves the image. At full size the encoder has no blocks, because every
    // step of an edit runs it forward and backward.
    for (int size = 4 * latent_size; size < resolution; size *= 2) {
        config.num_encoder_blocks.insert(config.num_encoder_blocks.begin(), 0);
        config.num_decoder_blocks.push_back(1);
    }
    // diffusers' class has one width for all levels.
    config.encoder_block_out_channels.assign(config.num_encoder_blocks.size(), 32);
    config.decoder_block_out_channels = config.encoder_block_out_channels;
    return config;
}

TrainedAutoencoder train_autoencoder(const ImageData& images, const ImageData& held_out,
                                     const TrainSettings& settings) {
    const auto file = settings.work / "autoencoder.safetensors";
    if (settings.resume && std::filesystem::exists(file)) {
        auto model = make_model(settings);
        load_parameters(*model, Weights::open_file(file));
        return finish(model, held_out);
    }
    std::vector<std::shared_ptr<AutoencoderTiny>> models;
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (int rank = 0; rank < settings.replicas; ++rank) {
        models.push_back(make_model(settings));
        flat.push_back(std::make_unique<FlatModel>(
            std::vector<std::shared_ptr<torch::nn::Module>>{models.back()}));
    }
    ReplicaGroup group(std::move(flat), {.weight_decay = 1e-4f});
    const std::int64_t step_samples = batch * settings.replicas;
    const std::int64_t steps = settings.autoencoder_samples / step_samples;
    Progress progress("autoencoder", steps * step_samples);
    double mean_loss = 0;

    run_ranks(settings.replicas, [&](int rank) {
        try {
            AutoencoderTiny& model = *models[static_cast<std::size_t>(rank)];
            for (std::int64_t step = 0; step < steps; ++step) {
                const double part = static_cast<double>(step) / static_cast<double>(steps);
                Random random(settings.seed, 0xae0000 + static_cast<std::uint64_t>(rank),
                              static_cast<std::uint64_t>(step) * 64);
                std::vector<std::int64_t> rows;
                for (int i = 0; i < batch; ++i)
                    rows.push_back(random.index(images.images.size(0)));
                auto generator = at::detail::createCPUGenerator(random.bits());
                const at::Tensor noise =
                    at::randn({batch, latent_channels, latent_size, latent_size}, generator);
                const Batch data = gather(images, at::tensor(rows));
                const at::Tensor loss = reconstruction_loss(model, data, part, noise);
                loss.backward();
                const double decay = static_cast<double>(step) / (static_cast<double>(step) + 10);
                const auto rate = static_cast<float>(
                    highest_rate * std::min(1.0, static_cast<double>(step) / 100) *
                    (.5 + .5 * std::cos(3.14159265 * part)));
                const auto result = group.step(
                    rank, {rate, static_cast<float>(std::min(.998, decay)), interrupted()});
                if (rank == 0) {
                    const double now = loss.item<double>();
                    mean_loss = step == 0 ? now : mean_loss + .02 * (now - mean_loss);
                    progress.update((step + 1) * step_samples,
                                    fmt::format("loss {:.4f}", mean_loss));
                }
                if (result.stop) break;
            }
        } catch (...) {
            group.fail();
            throw;
        }
    });
    progress.finish();
    if (interrupted())
        throw Interrupted(
            "while training the autoencoder; run the same command with --resume to train it again");

    group.replica(0).use_values(group.average());
    NamedTensors tensors;
    for (auto& [name, tensor] : module_tensors(*models[0]))
        tensors.emplace_back(name, tensor.contiguous());
    save_safetensors(file, tensors);
    auto model = make_model(settings);
    load_parameters(*model, Weights::open_file(file));
    return finish(model, held_out);
}

}  // namespace item3d
