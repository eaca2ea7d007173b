// How long a job has still to run, of all its stages.
#pragma once

#include "item3d/studio/estimate.h"

#include <nlohmann/json.hpp>

#include <optional>

namespace item3d {

/// Turns the progress of a stage into that of the edit: what the stage itself says is left, and
/// what the stages behind it are expected to take, at the pace at which this one runs.
class JobClock {
  public:
    JobClock() = default;
    explicit JobClock(const EditPlanSeconds& plan) : plan_(plan) {}

    /// Seconds left after so many that the job has run. progress: "stage", "done", "total" and
    /// "seconds_left" of a progress file. Nothing without a plan. Between what stages say, time
    /// runs down, but not below a second.
    std::optional<double> seconds_left(const nlohmann::json& progress, double seconds);

  private:
    std::optional<EditPlanSeconds> plan_;
    std::optional<double> left_;  ///< at `at_`
    double at_ = 0;
    double pace_ = 1;  ///< of this run, in expected seconds
};

}  // namespace item3d
