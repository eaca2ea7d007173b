// DDIM (Song et al. 2021) and the noise schedule of training, as diffusers' DDIMScheduler.
#pragma once

#include "item3d/models/config.h"

#include <torch/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// The keys of scheduler_config.json. The defaults are those of diffusers, not of Stable Diffusion.
struct DdimConfig {
    int num_train_timesteps = 1000;
    double beta_start = 0.0001;
    double beta_end = 0.02;
    std::string beta_schedule = "linear";      ///< or scaled_linear, squaredcos_cap_v2
    std::vector<double> trained_betas;         ///< used instead when not empty
    std::string prediction_type = "epsilon";   ///< or v_prediction, sample
    std::string timestep_spacing = "leading";  ///< or trailing, linspace
    int steps_offset = 0;                      ///< added to leading timesteps
    bool clip_sample = true;
    double clip_sample_range = 1.0;
    bool set_alpha_to_one = true;  ///< what follows the last step is noise-free
    bool rescale_betas_zero_snr = false;

    /// Also reads the configs of other schedulers (PNDM, Euler, ...): the keys mean the same, and
    /// what only DDIM clips is then not clipped. Throws InputError.
    static DdimConfig from_config(const Config& config);
    static DdimConfig from_json(const nlohmann::json& json,
                                const std::string& subject = "scheduler_config.json");
    nlohmann::json to_json() const;
    /// Stable Diffusion's training: 1000 steps, scaled-linear betas 0.00085 to 0.012, no clipping.
    static DdimConfig stable_diffusion(const std::string& prediction_type);
};

class DdimScheduler {
  public:
    DdimScheduler() : DdimScheduler(DdimConfig{}) {}
    explicit DdimScheduler(const DdimConfig& config);
    /// Reads FOLDER/scheduler_config.json.
    static DdimScheduler load(const std::filesystem::path& folder);

    const DdimConfig& config() const { return config_; }
    /// [num_train_timesteps] float32 on the CPU: the share of signal variance at each timestep.
    const torch::Tensor& alphas_cumprod() const { return alphas_cumprod_; }
    /// alphas_cumprod at integer `timesteps` [N], shaped [N, 1, 1, 1], on their device.
    torch::Tensor alphas_at(const torch::Tensor& timesteps) const;
    bool predicts_velocity() const { return config_.prediction_type == "v_prediction"; }

    /// sqrt(a) sample + sqrt(1 - a) noise; sample [N, C, H, W], timesteps [N] integers.
    torch::Tensor add_noise(const torch::Tensor& sample, const torch::Tensor& noise,
                            const torch::Tensor& timesteps) const;
    /// The target of v-prediction: sqrt(a) noise - sqrt(1 - a) sample.
    torch::Tensor get_velocity(const torch::Tensor& sample, const torch::Tensor& noise,
                               const torch::Tensor& timesteps) const;
    /// A network's output of the configured type -> the noise that it means.
    torch::Tensor to_noise(const torch::Tensor& model_output, const torch::Tensor& sample,
                           const torch::Tensor& timesteps) const;

    /// Chooses the timesteps of a sampling run, from noisy to clean.
    void set_timesteps(int steps);
    const std::vector<std::int64_t>& timesteps() const { return timesteps_; }
    /// The standard deviation that sampling starts from.
    double init_noise_sigma() const { return 1.0; }

    /// One step from `timestep` to the next. eta: 0 (DDIM) to 1 (DDPM); variance_noise: standard
    /// normal, as the sample, needed when eta > 0.
    torch::Tensor step(const torch::Tensor& model_output, std::int64_t timestep,
                       const torch::Tensor& sample, double eta = 0.0,
                       const torch::Tensor& variance_noise = {}) const;

  private:
    DdimConfig config_;
    torch::Tensor alphas_cumprod_;
    double final_alpha_ = 1.0;
    std::vector<std::int64_t> timesteps_;
};

}  // namespace item3d
