#include "item3d/baselines/dataset_update.h"

#include "item3d/baselines/masked_sampling.h"
#include "item3d/guidance/noised_latents.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr int ssim_window = 7;

at::Tensor similarity(const at::Tensor& a, const at::Tensor& b) {
    const auto mean = [](const at::Tensor& x) {
        return at::avg_pool2d(x, {ssim_window, ssim_window}, {1, 1});
    };
    const at::Tensor mean_a = mean(a), mean_b = mean(b);
    const at::Tensor variance_a = mean(a * a) - mean_a * mean_a;
    const at::Tensor variance_b = mean(b * b) - mean_b * mean_b;
    const at::Tensor covariance = mean(a * b) - mean_a * mean_b;
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    return ((2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
            ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2)))
        .mean();
}

}  // namespace

std::vector<std::int64_t> dataset_views(std::uint64_t seed, std::int64_t iteration, int batch,
                                        int views) {
    Random random =
        seeded_random(seed, BaselineDraw::choices, static_cast<std::uint64_t>(iteration));
    std::vector<std::int64_t> chosen;
    for (int i = 0; i < batch; ++i)
        chosen.push_back(random.index(views));
    if (iteration % edit_rate == 0) chosen.front() = iteration / edit_rate % views;
    return chosen;
}

at::Tensor photometric_loss(const at::Tensor& images, const at::Tensor& targets) {
    return (images - targets).abs().mean() + (1 - similarity(images, targets));
}

DatasetUpdate::DatasetUpdate(std::shared_ptr<const DiffusionModel> model,
                             const DatasetUpdateOptions& options)
    : model_(std::move(model)),
      options_(options),
      instructed_(*model_, options.instruction, options.negative_prompt, options.scales,
                  options.subject),
      images_(static_cast<std::size_t>(options.views)) {}

GuidanceOutput DatasetUpdate::step(const GuidanceInput& input, std::int64_t iteration) {
    const double began = seconds_now();
    const auto views = dataset_views(options_.seed, iteration,
                                     static_cast<int>(input.images.size(0)), options_.views);
    if (iteration % edit_rate == 0) {
        const auto edits = static_cast<std::uint64_t>(iteration / edit_rate);
        Random random = seeded_random(options_.seed, BaselineDraw::levels, edits);
        const auto steps = static_cast<double>(model_->schedule().config().num_train_timesteps);
        const auto low = static_cast<std::int64_t>(steps * options_.min_timestep);
        const auto high = static_cast<std::int64_t>(steps * options_.max_timestep);
        const at::Tensor current = input.images.detach().narrow(0, 0, 1);
        const at::Tensor original = input.reference.narrow(0, 0, 1);
        const at::Tensor noise = seeded_noise(instructed_.image_latents(original).sizes(),
                                              options_.seed, BaselineDraw::images, edits)
                                     .to(current.device());
        images_[static_cast<std::size_t>(views.front())] = instructed_.edit(
            current, original, low + random.index(high - low + 1), options_.steps, noise);
    }
    const double edited = seconds_now();
    std::vector<at::Tensor> targets;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const at::Tensor& image = images_[static_cast<std::size_t>(views[i])];
        targets.push_back(
            image.defined() ? image : input.reference.narrow(0, static_cast<std::int64_t>(i), 1));
    }
    const at::Tensor images = input.images.detach().clone().requires_grad_();
    const at::Tensor loss = photometric_loss(images, at::cat(targets));
    loss.backward();
    GuidanceOutput output;
    output.latents = input.images;
    output.latents_gradient = images.grad();
    output.direction_length = loss.item<float>();
    output.seconds_unet = edited - began;
    return output;
}

NamedTensors DatasetUpdate::state() const {
    NamedTensors tensors;
    for (std::size_t i = 0; i < images_.size(); ++i)
        if (images_[i].defined()) tensors.emplace_back("picture" + std::to_string(i), images_[i]);
    return tensors;
}

void DatasetUpdate::load_state(const NamedTensors& state) {
    for (std::size_t i = 0; i < images_.size(); ++i)
        for (const auto& [name, tensor] : state)
            if (name == "picture" + std::to_string(i))
                images_[i] = tensor.to(model_->device()).clone();
}

}  // namespace item3d
