// Measurement of a command's time and memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Wall-clock seconds of consecutive stages.
class StageTimes {
  public:
    StageTimes() : start_(Clock::now()), stage_start_(start_) {}
    void end_stage(const std::string& name) {
        const auto now = Clock::now();
        stages_.emplace_back(name, std::chrono::duration<double>(now - stage_start_).count());
        stage_start_ = now;
    }
    const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }
    double total() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_;
    Clock::time_point stage_start_;
    std::vector<std::pair<std::string, double>> stages_;
};

/// Returns the process's peak resident size in bytes.
std::int64_t peak_memory_bytes();

}  // namespace item3d
