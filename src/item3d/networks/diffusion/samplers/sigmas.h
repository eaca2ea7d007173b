// Noise levels of a sampling run.
#pragma once

#include "item3d/networks/diffusion/noise_schedule.h"

#include <vector>

namespace item3d {

/// The noise levels of a run and the timesteps that stand for them.
struct SigmaSteps {
    std::vector<double> timesteps;  ///< [n]
    std::vector<double> sigmas;     ///< [n + 1], the last one 0
};

/// sqrt((1 - abar) / abar) of each timestep of training, increasing.
std::vector<double> training_sigmas(const NoiseSchedule& schedule);
/// `sigmas` (of training) at a timestep between two of them.
double interpolate_sigma(const std::vector<double>& sigmas, double timestep);
/// n levels from `largest` to `smallest`, dense near the small ones (Karras et al. 2022, rho 7),
/// and their timesteps, linear in log sigma between those of training.
SigmaSteps karras_steps(const std::vector<double>& sigmas, double largest, double smallest, int n);

}  // namespace item3d
