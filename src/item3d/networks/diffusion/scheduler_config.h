// Configuration in scheduler/scheduler_config.json: the noise schedule of training, and the
// sampler.
#pragma once

#include "item3d/core/config.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class SamplerMethod { ddim, ddpm, euler, dpmpp_2m, pndm };

/// Keys of the file. The defaults are those of diffusers, not of Stable Diffusion.
struct SchedulerConfig {
    SamplerMethod method = SamplerMethod::ddim;  ///< "_class_name"
    int num_train_timesteps = 1000;
    double beta_start = 0.0001;
    double beta_end = 0.02;
    std::string beta_schedule = "linear";     ///< or scaled_linear, squaredcos_cap_v2
    std::vector<double> trained_betas;        ///< used instead of beta_schedule when not empty
    std::string prediction_type = "epsilon";  ///< or v_prediction, sample
    /// leading, trailing or linspace. If empty, Euler and DPM-Solver++ use linspace, and the other
    /// methods use leading.
    std::string timestep_spacing;
    int steps_offset = 0;  ///< added to leading timesteps
    bool clip_sample = true;
    double clip_sample_range = 1.0;
    /// True if abar is 1 after the last step, so that no noise is left.
    bool set_alpha_to_one = true;
    bool rescale_betas_zero_snr = false;
    bool use_karras_sigmas = false;  ///< for Euler and DPM-Solver++ only

    /// Reads the keys. clip_sample defaults to false for methods other than DDIM and DDPM. Throws
    /// InputError that names the key for an unsupported class, key or value.
    static SchedulerConfig from_config(const Config& config);
    static SchedulerConfig from_json(const nlohmann::json& json,
                                     const std::string& subject = "scheduler_config.json");
    nlohmann::json to_json() const;
    /// Returns the schedule that Stable Diffusion was trained with: 1000 steps, scaled-linear betas
    /// 0.00085 to 0.012, no clipping.
    static SchedulerConfig stable_diffusion(const std::string& prediction_type);

    /// Returns the same schedule with the sampler `name` of sampler_kinds(). Throws InputError for
    /// another name.
    SchedulerConfig with_sampler(const std::string& name) const;
    /// Name of the method in sampler_kinds().
    std::string sampler_name() const;

    /// Returns timestep_spacing, or the method's usual spacing if it is empty.
    std::string spacing() const;
    /// True if the method steps in sigma = sqrt(1 - abar) / sqrt(abar) (Euler, DPM-Solver++), false
    /// if it steps in timesteps.
    bool goes_by_sigma() const;
};

/// A value of the option --scheduler.
struct SamplerKind {
    std::string name;
    std::string description;
    SamplerMethod method;
    bool karras = false;
    int usual_steps = 30;
};
const std::vector<SamplerKind>& sampler_kinds();

}  // namespace item3d
