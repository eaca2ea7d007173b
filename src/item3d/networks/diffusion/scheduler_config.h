// scheduler/scheduler_config.json: the noise that a model was trained with, and how to sample.
#pragma once

#include "item3d/core/config.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

enum class SamplerMethod { ddim, ddpm, euler, dpmpp_2m, pndm };

/// The keys of the file. The defaults are those of diffusers, not of Stable Diffusion.
struct SchedulerConfig {
    SamplerMethod method = SamplerMethod::ddim;  ///< "_class_name"
    int num_train_timesteps = 1000;
    double beta_start = 0.0001;
    double beta_end = 0.02;
    std::string beta_schedule = "linear";     ///< or scaled_linear, squaredcos_cap_v2
    std::vector<double> trained_betas;        ///< used instead when not empty
    std::string prediction_type = "epsilon";  ///< or v_prediction, sample
    /// leading, trailing or linspace; empty: leading, for Euler and DPM-Solver++ linspace.
    std::string timestep_spacing;
    int steps_offset = 0;  ///< added to leading timesteps
    bool clip_sample = true;
    double clip_sample_range = 1.0;
    bool set_alpha_to_one = true;  ///< what follows the last step is noise-free
    bool rescale_betas_zero_snr = false;
    bool use_karras_sigmas = false;  ///< of Euler and DPM-Solver++

    /// What only DDIM and DDPM clip is not clipped where the file belongs to another class. Throws
    /// InputError that names the key for a class, key or value that is not supported.
    static SchedulerConfig from_config(const Config& config);
    static SchedulerConfig from_json(const nlohmann::json& json,
                                     const std::string& subject = "scheduler_config.json");
    nlohmann::json to_json() const;
    /// Stable Diffusion's training: 1000 steps, scaled-linear betas 0.00085 to 0.012, no clipping.
    static SchedulerConfig stable_diffusion(const std::string& prediction_type);

    /// The same model sampled by one of sampler_kinds(). Throws InputError for another name.
    SchedulerConfig with_sampler(const std::string& name) const;
    /// Its name in sampler_kinds().
    std::string sampler_name() const;

    /// timestep_spacing, or what is usual for the method.
    std::string spacing() const;
    /// Euler and DPM-Solver++ go by sigma = sqrt(1 - abar) / sqrt(abar), the others by timestep.
    bool goes_by_sigma() const;
};

/// What --scheduler offers.
struct SamplerKind {
    std::string name;
    std::string description;
    SamplerMethod method;
    bool karras = false;
    int usual_steps = 30;
};
const std::vector<SamplerKind>& sampler_kinds();

}  // namespace item3d
