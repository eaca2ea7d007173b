// COLMAP's program: its steps, what it says while they run, and how they fail.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct ColmapStep {
    std::string label;       ///< of the progress
    std::string counted;     ///< words of the lines that say that one more of `total` is done
    std::int64_t total = 0;  ///< pictures, or pairs of them
    std::string command;     ///< "mapper"
    std::vector<std::string> arguments;
};

/// How a step ended that no signal ended.
struct ColmapOutcome {
    int exit_code = 0;
    std::string telling;  ///< of what it printed, the line that says what went wrong
};

class ColmapProgram {
  public:
    /// program: its path; log: a file that what it prints is added to; threads: 0: as it chooses.
    ColmapProgram(std::filesystem::path program, std::filesystem::path log, int threads);

    /// Runs a step and shows how far it is. Throws ResourceError where a signal ended it,
    /// Interrupted after Ctrl-C; no process of it is left then.
    ColmapOutcome run(const ColmapStep& step) const;
    /// Throws ResourceError unless it ended well.
    void check(const ColmapStep& step, const ColmapOutcome& outcome) const;

    /// Adds "--NOW.use_gpu 0 --NOW.num_threads N", or BEFORE for NOW: COLMAP 3.13 renamed them, so
    /// the command is asked for its options. scratch: a file to be written.
    void add_device(ColmapStep& step, const std::string& now, const std::string& before,
                    const std::filesystem::path& scratch) const;

    int threads() const { return threads_; }

  private:
    std::filesystem::path program_, log_;
    int threads_;  ///< COLMAP's: -1 for each core one
};

}  // namespace item3d
