// Noise levels of a sampling run.
#pragma once

#include "item3d/networks/diffusion/noise_schedule.h"

#include <vector>

namespace item3d {

/// Noise levels of a run and the corresponding timesteps.
struct SigmaSteps {
    std::vector<double> timesteps;  ///< [n]
    std::vector<double> sigmas;     ///< [n + 1]; the last one is 0
};

/// Returns sqrt((1 - abar) / abar) of each training timestep, increasing.
std::vector<double> training_sigmas(const NoiseSchedule& schedule);
/// Interpolates the training `sigmas` at a fractional timestep.
double interpolate_sigma(const std::vector<double>& sigmas, double timestep);
/// Returns n levels from `largest` to `smallest`, denser at small values (Karras et al. 2022, with
/// rho = 7), and their timesteps. These are interpolated in log sigma between the timesteps of
/// training.
SigmaSteps karras_steps(const std::vector<double>& sigmas, double largest, double smallest, int n);

}  // namespace item3d
