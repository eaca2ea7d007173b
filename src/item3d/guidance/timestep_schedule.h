// The timestep of an iteration.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

/// Returns the timestep, 0 .. training_steps - 1, of an iteration of options.iterations, between
/// the options' min_timestep and max_timestep:
///   uniform    random: position `draw` in [0, 1);
///   anneal     falls linearly from max to min;
///   dreamtime  falls, and stays longest where coarse shapes become content (Huang et al. 2023,
///              DreamTime): with W(t) = exp(-(t - 0.8)^2 / (2 0.3^2)) above 0.8 of the training
///              steps, exp(-(t - 0.5)^2 / (2 0.5^2)) below 0.5 and 1 between, the timestep whose
///              share of W at and above it is nearest to the share of iterations done.
std::int64_t scheduled_timestep(const GuidanceOptions& options, std::int64_t training_steps,
                                std::int64_t iteration, double draw);

/// Returns the progress: 0 at the first iteration, rising to 1 at the end of the edit.
double progress_of(const GuidanceOptions& options, std::int64_t iteration);

/// Converts a paper's timestep, out of 1000, to a schedule of another length.
std::int64_t of_thousand(std::int64_t step, std::int64_t training_steps);

}  // namespace item3d
