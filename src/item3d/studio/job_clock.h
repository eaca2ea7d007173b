// Remaining time of a job, summed over all of its stages.
#pragma once

#include "item3d/studio/estimate.h"

#include <nlohmann/json.hpp>

#include <optional>

namespace item3d {

/// Estimator of an edit's remaining time. It is the running stage's own estimate, plus the expected
/// time of later stages at the pace of this run.
class JobClock {
  public:
    JobClock() = default;
    explicit JobClock(const EditPlanSeconds& plan) : plan_(plan) {}

    /// Returns the remaining seconds of a job that has run for `seconds`; nullopt if there are no
    /// expected times. progress: "stage", "done", "total" and "seconds_left" of a progress file.
    /// Between two reports of a stage the result counts down, but not below a second.
    std::optional<double> seconds_left(const nlohmann::json& progress, double seconds);

  private:
    std::optional<EditPlanSeconds> plan_;
    std::optional<double> left_;  ///< remaining seconds at time `at_`
    double at_ = 0;
    double pace_ = 1;  ///< pace of this run, relative to the expected seconds
};

}  // namespace item3d
