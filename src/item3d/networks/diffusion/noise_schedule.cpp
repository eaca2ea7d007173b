#include "item3d/networks/diffusion/noise_schedule.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {
namespace {

/// Returns betas whose product of (1 - beta) follows a squared cosine (Nichol and Dhariwal 2021).
at::Tensor squared_cosine_betas(int count) {
    const auto alpha_bar = [](double t) {
        const double cosine = std::cos((t + 0.008) / 1.008 * M_PI / 2);
        return cosine * cosine;
    };
    std::vector<float> betas;
    for (int i = 0; i < count; ++i)
        betas.push_back(
            static_cast<float>(std::min(1 - alpha_bar(static_cast<double>(i + 1) / count) /
                                                alpha_bar(static_cast<double>(i) / count),
                                        0.999)));
    return at::tensor(betas);
}

at::Tensor make_betas(const SchedulerConfig& config) {
    const int count = config.num_train_timesteps;
    if (!config.trained_betas.empty()) return at::tensor(config.trained_betas).to(at::kFloat);
    if (config.beta_schedule == "linear")
        return at::linspace(config.beta_start, config.beta_end, count, at::kFloat);
    if (config.beta_schedule == "squaredcos_cap_v2") return squared_cosine_betas(count);
    return at::linspace(std::sqrt(config.beta_start), std::sqrt(config.beta_end), count, at::kFloat)
        .square();
}

/// Shifts and scales the schedule so that its last step has no signal (Lin et al. 2024).
at::Tensor rescale_to_zero_snr(const at::Tensor& betas) {
    at::Tensor root = (1 - betas).cumprod(0).sqrt();
    const at::Tensor first = root[0].clone(), last = root[-1].clone();
    root = (root - last) * (first / (first - last));
    const at::Tensor bar = root.square();
    return 1 - at::cat({bar.slice(0, 0, 1), bar.slice(0, 1) / bar.slice(0, 0, -1)});
}

}  // namespace

NoiseSchedule::NoiseSchedule(const SchedulerConfig& config) : config_(config) {
    at::Tensor betas = make_betas(config_);
    const bool zero_snr = config_.rescale_betas_zero_snr && config_.method != SamplerMethod::pndm;
    if (zero_snr) betas = rescale_to_zero_snr(betas);
    alphas_cumprod_ = (1 - betas).cumprod(0);
    // Sigma would be infinite where abar is 0.
    if (zero_snr && config_.goes_by_sigma()) alphas_cumprod_[-1] = std::ldexp(1.0, -24);
}

NoiseSchedule NoiseSchedule::load(const std::filesystem::path& folder) {
    return NoiseSchedule(
        SchedulerConfig::from_config(Config::read(folder / "scheduler_config.json")));
}

at::Tensor NoiseSchedule::alphas_at(const at::Tensor& timesteps) const {
    return alphas_cumprod_.to(timesteps.device())
        .index_select(0, timesteps.reshape({-1}).to(at::kLong))
        .reshape({-1, 1, 1, 1});
}

at::Tensor NoiseSchedule::add_noise(const at::Tensor& sample, const at::Tensor& noise,
                                    const at::Tensor& timesteps) const {
    const at::Tensor alpha = alphas_at(timesteps);
    return alpha.sqrt() * sample + (1 - alpha).sqrt() * noise;
}

at::Tensor NoiseSchedule::get_velocity(const at::Tensor& sample, const at::Tensor& noise,
                                       const at::Tensor& timesteps) const {
    const at::Tensor alpha = alphas_at(timesteps);
    return alpha.sqrt() * noise - (1 - alpha).sqrt() * sample;
}

at::Tensor NoiseSchedule::to_noise(const at::Tensor& model_output, const at::Tensor& sample,
                                   const at::Tensor& timesteps) const {
    if (config_.prediction_type == "epsilon") return model_output;
    const at::Tensor alpha = alphas_at(timesteps);
    if (config_.prediction_type == "sample")
        return (sample - alpha.sqrt() * model_output) / (1 - alpha).sqrt();
    return alpha.sqrt() * model_output + (1 - alpha).sqrt() * sample;
}

Prediction NoiseSchedule::interpret(const at::Tensor& model_output, const at::Tensor& sample,
                                    double alpha) const {
    const double signal = std::sqrt(alpha), deviation = std::sqrt(1 - alpha);
    if (config_.prediction_type == "epsilon")
        return {(sample - deviation * model_output) / signal, model_output};
    if (config_.prediction_type == "sample")
        return {model_output, (sample - signal * model_output) / deviation};
    return {signal * sample - deviation * model_output, signal * model_output + deviation * sample};
}

}  // namespace item3d
