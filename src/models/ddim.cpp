#include "item3d/models/ddim.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Nichol and Dhariwal 2021: betas whose product of (1 - beta) follows a squared cosine.
torch::Tensor squared_cosine_betas(int count) {
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
    return torch::tensor(betas);
}

torch::Tensor make_betas(const DdimConfig& config) {
    const int count = config.num_train_timesteps;
    if (!config.trained_betas.empty())
        return torch::tensor(config.trained_betas).to(torch::kFloat32);
    if (config.beta_schedule == "linear")
        return torch::linspace(config.beta_start, config.beta_end, count, torch::kFloat32);
    if (config.beta_schedule == "squaredcos_cap_v2") return squared_cosine_betas(count);
    return torch::linspace(std::sqrt(config.beta_start), std::sqrt(config.beta_end), count,
                           torch::kFloat32)
        .square();
}

/// Lin et al. 2024: shifts and scales the schedule so that its last step holds no signal.
torch::Tensor rescale_to_zero_snr(const torch::Tensor& betas) {
    torch::Tensor root = (1 - betas).cumprod(0).sqrt();
    const torch::Tensor first = root[0].clone(), last = root[-1].clone();
    root = (root - last) * (first / (first - last));
    const torch::Tensor bar = root.square();
    return 1 - torch::cat({bar.slice(0, 0, 1), bar.slice(0, 1) / bar.slice(0, 0, -1)});
}

/// Halves to even, as numpy rounds.
std::int64_t round_to_even(double value) {
    return static_cast<std::int64_t>(std::nearbyint(value));
}

}  // namespace

DdimScheduler::DdimScheduler(const DdimConfig& config) : config_(config) {
    torch::Tensor betas = make_betas(config_);
    if (config_.rescale_betas_zero_snr) betas = rescale_to_zero_snr(betas);
    alphas_cumprod_ = (1 - betas).cumprod(0);
    final_alpha_ = config_.set_alpha_to_one ? 1.0 : alphas_cumprod_[0].item<double>();
}

DdimScheduler DdimScheduler::load(const std::filesystem::path& folder) {
    return DdimScheduler(DdimConfig::from_config(Config::read(folder / "scheduler_config.json")));
}

torch::Tensor DdimScheduler::alphas_at(const torch::Tensor& timesteps) const {
    return alphas_cumprod_.to(timesteps.device())
        .index_select(0, timesteps.reshape({-1}).to(torch::kInt64))
        .reshape({-1, 1, 1, 1});
}

torch::Tensor DdimScheduler::add_noise(const torch::Tensor& sample, const torch::Tensor& noise,
                                       const torch::Tensor& timesteps) const {
    const torch::Tensor alpha = alphas_at(timesteps);
    return alpha.sqrt() * sample + (1 - alpha).sqrt() * noise;
}

torch::Tensor DdimScheduler::get_velocity(const torch::Tensor& sample, const torch::Tensor& noise,
                                          const torch::Tensor& timesteps) const {
    const torch::Tensor alpha = alphas_at(timesteps);
    return alpha.sqrt() * noise - (1 - alpha).sqrt() * sample;
}

torch::Tensor DdimScheduler::to_noise(const torch::Tensor& model_output,
                                      const torch::Tensor& sample,
                                      const torch::Tensor& timesteps) const {
    if (config_.prediction_type == "epsilon") return model_output;
    const torch::Tensor alpha = alphas_at(timesteps);
    if (config_.prediction_type == "sample")
        return (sample - alpha.sqrt() * model_output) / (1 - alpha).sqrt();
    return alpha.sqrt() * model_output + (1 - alpha).sqrt() * sample;
}

void DdimScheduler::set_timesteps(int steps) {
    const int count = config_.num_train_timesteps;
    ITEM3D_CHECK(steps >= 1 && steps <= count, "steps must be 1 to num_train_timesteps");
    timesteps_.clear();
    if (config_.timestep_spacing == "linspace") {
        for (int i = steps - 1; i >= 0; --i)
            timesteps_.push_back(
                steps == 1 ? 0 : round_to_even(static_cast<double>(i) * (count - 1) / (steps - 1)));
    } else if (config_.timestep_spacing == "leading") {
        for (int i = steps - 1; i >= 0; --i)
            timesteps_.push_back(static_cast<std::int64_t>(i) * (count / steps) +
                                 config_.steps_offset);
    } else {
        for (int i = 0; i < steps; ++i)
            timesteps_.push_back(round_to_even(count - static_cast<double>(i) * count / steps) - 1);
    }
    for (std::int64_t& timestep : timesteps_)
        timestep = std::min<std::int64_t>(timestep, count - 1);
}

torch::Tensor DdimScheduler::step(const torch::Tensor& model_output, std::int64_t timestep,
                                  const torch::Tensor& sample, double eta,
                                  const torch::Tensor& variance_noise) const {
    ITEM3D_CHECK(!timesteps_.empty(), "set_timesteps comes first");
    ITEM3D_CHECK(timestep >= 0 && timestep < config_.num_train_timesteps, "no such timestep");
    const auto stride = config_.num_train_timesteps / static_cast<std::int64_t>(timesteps_.size());
    const std::int64_t previous = timestep - stride;
    const double alpha = alphas_cumprod_[timestep].item<double>();
    const double alpha_next =
        previous >= 0 ? alphas_cumprod_[previous].item<double>() : final_alpha_;

    torch::Tensor clean, noise;
    if (config_.prediction_type == "epsilon") {
        clean = (sample - std::sqrt(1 - alpha) * model_output) / std::sqrt(alpha);
        noise = model_output;
    } else if (config_.prediction_type == "sample") {
        clean = model_output;
        noise = (sample - std::sqrt(alpha) * clean) / std::sqrt(1 - alpha);
    } else {
        clean = std::sqrt(alpha) * sample - std::sqrt(1 - alpha) * model_output;
        noise = std::sqrt(alpha) * model_output + std::sqrt(1 - alpha) * sample;
    }
    if (config_.clip_sample)
        clean = clean.clamp(-config_.clip_sample_range, config_.clip_sample_range);

    const double variance = (1 - alpha_next) / (1 - alpha) * (1 - alpha / alpha_next);
    const double deviation = eta * std::sqrt(std::max(variance, 0.0));
    const double direction = std::sqrt(std::max(1 - alpha_next - deviation * deviation, 0.0));
    torch::Tensor result = std::sqrt(alpha_next) * clean + direction * noise;
    if (eta > 0) {
        ITEM3D_CHECK(variance_noise.defined(), "eta > 0 needs noise");
        result = result + deviation * variance_noise;
    }
    return result;
}

DdimConfig DdimConfig::from_json(const nlohmann::json& json, const std::string& subject) {
    return from_config(Config(json, subject));
}

DdimConfig DdimConfig::from_config(const Config& config) {
    DdimConfig result;
    const bool own = config.text("_class_name", "DDIMScheduler") == "DDIMScheduler";
    config.expect("thresholding", false);
    result.num_train_timesteps = config.size("num_train_timesteps", result.num_train_timesteps);
    if (result.num_train_timesteps > 100'000) config.fail("num_train_timesteps", "at most 100000");
    result.beta_start = config.number("beta_start", result.beta_start);
    result.beta_end = config.number("beta_end", result.beta_end);
    for (const double beta : {result.beta_start, result.beta_end})
        if (!(beta >= 0 && beta < 1)) config.fail("beta_start", "betas from 0 to below 1");
    result.trained_betas = config.numbers("trained_betas");
    if (!result.trained_betas.empty() &&
        static_cast<int>(result.trained_betas.size()) != result.num_train_timesteps)
        config.reject("trained_betas", "expected num_train_timesteps numbers");
    const auto choice = [&](const char* key, std::string& value,
                            const std::vector<std::string>& choices) {
        value = config.text(key, value);
        std::string wanted;
        for (const std::string& name : choices)
            wanted += (wanted.empty() ? "" : ", ") + name;
        if (std::find(choices.begin(), choices.end(), value) == choices.end())
            config.fail(key, "one of " + wanted);
    };
    choice("beta_schedule", result.beta_schedule, {"linear", "scaled_linear", "squaredcos_cap_v2"});
    choice("prediction_type", result.prediction_type, {"epsilon", "v_prediction", "sample"});
    choice("timestep_spacing", result.timestep_spacing, {"leading", "trailing", "linspace"});
    result.steps_offset = config.integer("steps_offset", 0);
    if (result.steps_offset < 0 || result.steps_offset >= result.num_train_timesteps)
        config.fail("steps_offset", "0 to num_train_timesteps");
    result.clip_sample = config.boolean("clip_sample", own);
    result.clip_sample_range = config.number("clip_sample_range", 1.0);
    result.set_alpha_to_one = config.boolean("set_alpha_to_one", own);
    result.rescale_betas_zero_snr = config.boolean("rescale_betas_zero_snr", false);
    return result;
}

nlohmann::json DdimConfig::to_json() const {
    nlohmann::json json = {
        {"_class_name", "DDIMScheduler"},
        {"beta_end", beta_end},
        {"beta_schedule", beta_schedule},
        {"beta_start", beta_start},
        {"clip_sample", clip_sample},
        {"clip_sample_range", clip_sample_range},
        {"num_train_timesteps", num_train_timesteps},
        {"prediction_type", prediction_type},
        {"rescale_betas_zero_snr", rescale_betas_zero_snr},
        {"set_alpha_to_one", set_alpha_to_one},
        {"steps_offset", steps_offset},
        {"thresholding", false},
        {"timestep_spacing", timestep_spacing},
        {"trained_betas", nullptr},
    };
    if (!trained_betas.empty()) json["trained_betas"] = trained_betas;
    return json;
}

DdimConfig DdimConfig::stable_diffusion(const std::string& prediction_type) {
    DdimConfig config;
    config.beta_start = 0.00085;
    config.beta_end = 0.012;
    config.beta_schedule = "scaled_linear";
    config.prediction_type = prediction_type;
    config.steps_offset = 1;
    config.clip_sample = false;
    config.set_alpha_to_one = false;
    return config;
}

}  // namespace item3d
