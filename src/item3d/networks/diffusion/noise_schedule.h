// Noise schedule of training: the signal variance at each timestep, and the conversion of a
// network's output to image and noise.
#pragma once

#include "item3d/networks/diffusion/scheduler_config.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>

namespace item3d {

/// Clean image and noise that a network's output implies.
struct Prediction {
    at::Tensor clean;
    at::Tensor noise;
};

/// Schedule of x_t = sqrt(abar_t) x_0 + sqrt(1 - abar_t) eps, where abar is alphas_cumprod (Ho et
/// al. 2020).
class NoiseSchedule {
  public:
    NoiseSchedule() : NoiseSchedule(SchedulerConfig{}) {}
    /// Behaves as diffusers' class of the configured method. With rescale_betas_zero_snr, Euler and
    /// DPM-Solver++ keep a last abar of 2^-24, and PNDM ignores the key.
    explicit NoiseSchedule(const SchedulerConfig& config);
    /// Reads FOLDER/scheduler_config.json. Throws InputError.
    static NoiseSchedule load(const std::filesystem::path& folder);

    const SchedulerConfig& config() const { return config_; }
    /// Fraction of signal variance at each timestep, [num_train_timesteps] float32 on the CPU.
    const at::Tensor& alphas_cumprod() const { return alphas_cumprod_; }
    /// Returns alphas_cumprod at integer `timesteps` [N] as [N, 1, 1, 1], on the device of
    /// `timesteps`.
    at::Tensor alphas_at(const at::Tensor& timesteps) const;
    bool predicts_velocity() const { return config_.prediction_type == "v_prediction"; }

    /// Returns sqrt(a) sample + sqrt(1 - a) noise, where a is alphas_at(timesteps). sample is [N,
    /// C, H, W], timesteps are integers [N].
    at::Tensor add_noise(const at::Tensor& sample, const at::Tensor& noise,
                         const at::Tensor& timesteps) const;
    /// Returns the target of v-prediction: sqrt(a) noise - sqrt(1 - a) sample, with the same a.
    at::Tensor get_velocity(const at::Tensor& sample, const at::Tensor& noise,
                            const at::Tensor& timesteps) const;
    /// Converts a network's output of the configured type to noise.
    at::Tensor to_noise(const at::Tensor& model_output, const at::Tensor& sample,
                        const at::Tensor& timesteps) const;
    /// Converts a network's output at one abar to clean image and noise. `sample` is x_t.
    Prediction interpret(const at::Tensor& model_output, const at::Tensor& sample,
                         double alpha_cumprod) const;

  private:
    SchedulerConfig config_;
    at::Tensor alphas_cumprod_;
};

}  // namespace item3d
