#include "item3d/networks/diffusion/scheduler_config.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

/// Classes of diffusers and their methods. The first class of each method is the method itself. The
/// other classes are trained with the same noise, and are sampled here by the nearest supported
/// method.
const std::vector<std::pair<std::string, SamplerMethod>>& class_names() {
    static const std::vector<std::pair<std::string, SamplerMethod>> names = {
        {"DDIMScheduler", SamplerMethod::ddim},
        {"DDPMScheduler", SamplerMethod::ddpm},
        {"EulerDiscreteScheduler", SamplerMethod::euler},
        {"DPMSolverMultistepScheduler", SamplerMethod::dpmpp_2m},
        {"PNDMScheduler", SamplerMethod::pndm},
        {"EulerAncestralDiscreteScheduler", SamplerMethod::euler},
        {"HeunDiscreteScheduler", SamplerMethod::euler},
        {"KDPM2DiscreteScheduler", SamplerMethod::euler},
        {"LMSDiscreteScheduler", SamplerMethod::euler},
        {"DEISMultistepScheduler", SamplerMethod::dpmpp_2m},
        {"DPMSolverSinglestepScheduler", SamplerMethod::dpmpp_2m},
        {"UniPCMultistepScheduler", SamplerMethod::dpmpp_2m},
    };
    return names;
}

std::string class_name(SamplerMethod method) {
    for (const auto& [name, known] : class_names())
        if (known == method) return name;
    ITEM3D_CHECK(false, "a sampler without a class");
}

std::string choice(const Config& config, const std::string& key, const std::string& fallback,
                   const std::vector<std::string>& choices) {
    const std::string value = config.text(key, fallback);
    if (value != fallback && std::find(choices.begin(), choices.end(), value) == choices.end())
        config.fail(key, fmt::format("one of {}", fmt::join(choices, ", ")));
    return value;
}

bool is_beta(double value) {
    return value > 0 && value < 1;
}

SamplerMethod read_method(const Config& config) {
    const std::string name = config.text("_class_name", "DDIMScheduler");
    std::vector<std::string> known;
    for (const auto& [class_name, method] : class_names()) {
        if (class_name == name) return method;
        known.push_back(class_name);
    }
    config.fail("_class_name", fmt::format("one of {}", fmt::join(known, ", ")));
}

/// Throws InputError for unsupported variants of a method. Keys that only other classes read have
/// no effect.
void refuse_variants(const Config& config, SamplerMethod method) {
    config.expect("thresholding", false);
    if (method == SamplerMethod::euler || method == SamplerMethod::dpmpp_2m) {
        config.expect("use_exponential_sigmas", false);
        config.expect("use_beta_sigmas", false);
        config.expect("final_sigmas_type", "zero");
    }
    if (method == SamplerMethod::euler) {
        config.expect("interpolation_type", "linear");
        config.expect("timestep_type", "discrete");
        for (const char* key : {"sigma_min", "sigma_max"})
            if (config.has(key)) config.fail(key, "null (no other value is supported)");
    }
    if (method == SamplerMethod::dpmpp_2m) {
        config.expect("algorithm_type", "dpmsolver++");
        config.expect("solver_order", 2);
        config.expect("solver_type", "midpoint");
        config.expect("use_lu_lambdas", false);
        config.expect("use_flow_sigmas", false);
        config.expect("use_dynamic_shifting", false);
        config.expect("lambda_min_clipped", "-Infinity");
        if (config.has("variance_type")) config.fail("variance_type", "null");
    }
    if (method == SamplerMethod::ddpm) config.expect("variance_type", "fixed_small");
    if (method == SamplerMethod::pndm && !config.boolean("skip_prk_steps", false))
        config.fail("skip_prk_steps", "true (Runge-Kutta steps are not supported)");
}

/// Throws InputError for epsilon prediction with zero terminal SNR, because an epsilon of pure
/// noise says nothing about the image.
void refuse_zero_snr_epsilon(const SchedulerConfig& scheduler, const Config& config) {
    if (scheduler.rescale_betas_zero_snr && !scheduler.goes_by_sigma() &&
        scheduler.method != SamplerMethod::pndm && scheduler.prediction_type == "epsilon")
        config.reject("rescale_betas_zero_snr", "needs prediction_type v_prediction or sample");
}

}  // namespace

SchedulerConfig SchedulerConfig::from_json(const nlohmann::json& json, const std::string& subject) {
    return from_config(Config(json, subject));
}

SchedulerConfig SchedulerConfig::from_config(const Config& config) {
    SchedulerConfig result;
    result.method = read_method(config);
    if (config.text("_class_name", class_name(result.method)) == class_name(result.method))
        refuse_variants(config, result.method);
    else
        note(fmt::format("{} is not supported: images are sampled by {}",
                         config.text("_class_name", ""), class_name(result.method)));
    const bool ddim = result.method == SamplerMethod::ddim;
    result.num_train_timesteps = config.size("num_train_timesteps", result.num_train_timesteps);
    if (result.num_train_timesteps > 100'000) config.fail("num_train_timesteps", "at most 100000");
    result.beta_start = config.number("beta_start", result.beta_start);
    result.beta_end = config.number("beta_end", result.beta_end);
    for (const double beta : {result.beta_start, result.beta_end})
        if (!is_beta(beta)) config.fail("beta_start", "betas above 0 and below 1");
    result.trained_betas = config.numbers("trained_betas");
    if (!std::all_of(result.trained_betas.begin(), result.trained_betas.end(), is_beta))
        config.reject("trained_betas", "expected numbers above 0 and below 1");
    if (!result.trained_betas.empty() &&
        static_cast<int>(result.trained_betas.size()) != result.num_train_timesteps)
        config.reject("trained_betas", "expected num_train_timesteps numbers");
    result.beta_schedule = choice(config, "beta_schedule", result.beta_schedule,
                                  {"linear", "scaled_linear", "squaredcos_cap_v2"});
    result.prediction_type = choice(config, "prediction_type", result.prediction_type,
                                    {"epsilon", "v_prediction", "sample"});
    if (result.method == SamplerMethod::pndm && result.prediction_type == "sample")
        config.fail("prediction_type", "epsilon or v_prediction");
    result.timestep_spacing =
        choice(config, "timestep_spacing", "", {"leading", "trailing", "linspace"});
    result.steps_offset = config.integer("steps_offset", 0);
    if (result.steps_offset < 0 || result.steps_offset >= result.num_train_timesteps)
        config.fail("steps_offset", "0 to num_train_timesteps");
    result.clip_sample =
        config.boolean("clip_sample", ddim || result.method == SamplerMethod::ddpm);
    result.clip_sample_range = config.number("clip_sample_range", 1.0);
    result.set_alpha_to_one = config.boolean("set_alpha_to_one", ddim);
    result.rescale_betas_zero_snr = config.boolean("rescale_betas_zero_snr", false);
    result.use_karras_sigmas = config.boolean("use_karras_sigmas", false);
    refuse_zero_snr_epsilon(result, config);
    return result;
}

nlohmann::json SchedulerConfig::to_json() const {
    nlohmann::json json = {
        {"_class_name", class_name(method)},
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
        {"timestep_spacing", spacing()},
        {"trained_betas", nullptr},
    };
    if (!trained_betas.empty()) json["trained_betas"] = trained_betas;
    if (goes_by_sigma()) json["use_karras_sigmas"] = use_karras_sigmas;
    if (method == SamplerMethod::pndm) json["skip_prk_steps"] = true;
    return json;
}

SchedulerConfig SchedulerConfig::stable_diffusion(const std::string& prediction_type) {
    SchedulerConfig config;
    config.beta_start = 0.00085;
    config.beta_end = 0.012;
    config.beta_schedule = "scaled_linear";
    config.prediction_type = prediction_type;
    config.steps_offset = 1;
    config.clip_sample = false;
    config.set_alpha_to_one = false;
    return config;
}

SchedulerConfig SchedulerConfig::with_sampler(const std::string& name) const {
    std::vector<std::string> names;
    for (const SamplerKind& kind : sampler_kinds()) {
        names.push_back(kind.name);
        if (kind.name != name) continue;
        SchedulerConfig result = *this;
        result.method = kind.method;
        result.use_karras_sigmas = kind.karras;
        const bool zero_snr = rescale_betas_zero_snr && method != SamplerMethod::pndm;
        if (kind.method == SamplerMethod::pndm && (zero_snr || prediction_type == "sample"))
            throw InputError("pndm",
                             "cannot sample a model trained to zero SNR or to predict the "
                             "sample",
                             "choose another scheduler");
        refuse_zero_snr_epsilon(result, Config(nlohmann::json::object(), name));
        return result;
    }
    throw InputError("--scheduler", fmt::format("'{}' is not known", name),
                     fmt::format("choose one of {}", fmt::join(names, ", ")));
}

std::string SchedulerConfig::sampler_name() const {
    for (const SamplerKind& kind : sampler_kinds())
        if (kind.method == method && (kind.karras == use_karras_sigmas || !goes_by_sigma()))
            return kind.name;
    ITEM3D_CHECK(false, "a sampler without a name");
}

std::string SchedulerConfig::spacing() const {
    if (!timestep_spacing.empty()) return timestep_spacing;
    return goes_by_sigma() ? "linspace" : "leading";
}

bool SchedulerConfig::goes_by_sigma() const {
    return method == SamplerMethod::euler || method == SamplerMethod::dpmpp_2m;
}

const std::vector<SamplerKind>& sampler_kinds() {
    static const std::vector<SamplerKind> kinds = {
        {"ddim", "Song et al. 2021, deterministic", SamplerMethod::ddim, false, 50},
        {"ddpm", "Ho et al. 2020, new noise in each step; needs many steps", SamplerMethod::ddpm,
         false, 250},
        {"euler", "Euler's method in sigma", SamplerMethod::euler, false, 30},
        {"euler-karras", "the same, sigmas spaced as Karras et al. 2022", SamplerMethod::euler,
         true, 30},
        {"dpmpp-2m", "DPM-Solver++ of second order, Lu et al. 2022; needs few steps",
         SamplerMethod::dpmpp_2m, false, 25},
        {"dpmpp-2m-karras", "the same, sigmas spaced as Karras et al. 2022",
         SamplerMethod::dpmpp_2m, true, 25},
        {"pndm", "linear multistep of fourth order, Liu et al. 2022", SamplerMethod::pndm, false,
         50},
    };
    return kinds;
}

}  // namespace item3d
