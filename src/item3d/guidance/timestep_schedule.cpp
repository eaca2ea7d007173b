#include "item3d/guidance/timestep_schedule.h"

#include "item3d/core/error.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr double upper_mode = 0.8, lower_mode = 0.5;  // DreamTime's m1 and m2, in training steps
constexpr double upper_spread = 0.3, lower_spread = 0.5;  // DreamTime's s1 and s2

double dreamtime_weight(double part) {
    const auto bell = [](double distance, double spread) {
        return std::exp(-0.5 * distance * distance / (spread * spread));
    };
    if (part > upper_mode) return bell(part - upper_mode, upper_spread);
    if (part < lower_mode) return bell(part - lower_mode, lower_spread);
    return 1;
}

std::int64_t dreamtime(std::int64_t low, std::int64_t high, std::int64_t training_steps,
                       double progress) {
    const auto weight = [&](std::int64_t t) {
        return dreamtime_weight(static_cast<double>(t) / static_cast<double>(training_steps));
    };
    double total = 0;
    for (std::int64_t t = low; t <= high; ++t)
        total += weight(t);
    std::int64_t nearest = high;
    double above = 0, distance = 1;
    for (std::int64_t t = high; t >= low; --t) {
        above += weight(t) / total;
        if (std::abs(above - progress) >= distance) break;
        distance = std::abs(above - progress);
        nearest = t;
    }
    return nearest;
}

}  // namespace

double progress_of(const GuidanceOptions& options, std::int64_t iteration) {
    const auto all = static_cast<double>(std::max<std::int64_t>(1, options.iterations));
    return std::clamp(static_cast<double>(iteration) / all, 0.0, 1.0);
}

std::int64_t of_thousand(std::int64_t step, std::int64_t training_steps) {
    return step * training_steps / 1000;
}

std::int64_t scheduled_timestep(const GuidanceOptions& options, std::int64_t training_steps,
                                std::int64_t iteration, double draw) {
    const auto steps = static_cast<double>(training_steps);
    const double low = options.min_timestep * steps, high = options.max_timestep * steps;
    const auto whole = [&](double t) {
        return std::clamp<std::int64_t>(static_cast<std::int64_t>(t), 0, training_steps - 1);
    };
    switch (options.timestep_schedule) {
        case TimestepSchedule::uniform:
            return whole(low + (high - low) * draw);
        case TimestepSchedule::anneal:
            return whole(high + (low - high) * progress_of(options, iteration));
        case TimestepSchedule::dreamtime:
            return dreamtime(whole(low), whole(high), training_steps,
                             progress_of(options, iteration));
    }
    ITEM3D_CHECK(false, "unknown timestep schedule");
}

}  // namespace item3d
