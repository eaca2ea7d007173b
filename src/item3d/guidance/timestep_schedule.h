// The timestep of an iteration.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

/// Returns the timestep of an iteration, from 0 to training_steps - 1, between min_timestep and
/// max_timestep of the options. options.timestep_schedule selects one of these schedules:
///   uniform    random: `draw`, in [0, 1), is the position between the two;
///   anneal     falls linearly from the maximum to the minimum;
///   dreamtime  falls, and stays longest where coarse shapes become content (Huang et al. 2023,
///              DreamTime). Let t be a timestep as a share of the training steps, and W(t) its
///              weight: exp(-(t - 0.8)^2 / (2 0.3^2)) above 0.8, exp(-(t - 0.5)^2 / (2 0.5^2))
///              below 0.5, and 1 between. The timestep of an iteration is the one for which the
///              share of W at and above it is nearest to the share of iterations done.
std::int64_t scheduled_timestep(const GuidanceOptions& options, std::int64_t training_steps,
                                std::int64_t iteration, double draw);

/// Returns the progress, which rises from 0 at the first iteration to 1 at the end of the edit.
double progress_of(const GuidanceOptions& options, std::int64_t iteration);

/// Converts a paper's timestep, out of 1000, to a schedule of `training_steps` timesteps.
std::int64_t of_thousand(std::int64_t step, std::int64_t training_steps);

}  // namespace item3d
