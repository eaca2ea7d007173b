#include "item3d/studio/job_clock.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

namespace item3d {
namespace {

double progress_number(const nlohmann::json& progress, const char* key) {
    const auto found = progress.find(key);
    return found != progress.end() && found->is_number() ? found->get<double>() : 0;
}

/// Returns the ratio of a stage's measured pace to the expected one. It is 1 until enough of the
/// stage is done.
double measured_pace(double left, double done, double total, double expected) {
    constexpr double slowest = 8, enough = 0.05;
    if (total <= 0 || done < enough * total || done >= total || expected <= 0) return 1;
    return std::clamp(left * total / (total - done) / expected, 1 / slowest, slowest);
}

}  // namespace

std::optional<double> JobClock::seconds_left(const nlohmann::json& progress, double seconds) {
    constexpr double minimum = 1;
    if (!plan_) return std::nullopt;
    const auto& [before, optimize, detail, after] = *plan_;
    const std::string stage = progress.value("stage", std::string());
    const double done = progress_number(progress, "done"),
                 total = progress_number(progress, "total");
    const double said = progress_number(progress, "seconds_left");
    const bool says = progress.contains("seconds_left") && progress["seconds_left"].is_number();
    if (!left_) std::tie(left_, at_) = std::pair{plan_->total(), 0.0};
    double left = *left_ - (seconds - at_);
    if (stage == "fit" && says) {
        left = said + optimize + detail + after;
    } else if (stage == "edit" && says) {
        pace_ = measured_pace(said, done, total, optimize);
        left = said + pace_ * (detail + after);
    } else if (stage == "detail" && says) {
        left = said + pace_ * after;
    }
    left_ = std::max(left, minimum);
    at_ = seconds;
    return left_;
}

}  // namespace item3d
