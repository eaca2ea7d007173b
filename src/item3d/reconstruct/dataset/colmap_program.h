// Runner of the COLMAP program: its steps, progress and failures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct ColmapStep {
    std::string label;       ///< label of the progress
    std::string counted;     ///< text of the output lines that count one more of `total`
    std::int64_t total = 0;  ///< number of images, or of pairs
    std::string command;     ///< "mapper"
    std::vector<std::string> arguments;
};

/// Outcome of a step that was not ended by a signal.
struct ColmapOutcome {
    int exit_code = 0;
    std::string telling;  ///< output line that states the error
};

class ColmapProgram {
  public:
    /// program: its path; log: file that its output is appended to; threads: 0: COLMAP's choice.
    ColmapProgram(std::filesystem::path program, std::filesystem::path log, int threads);

    /// Runs a step and shows its progress. Throws ResourceError if a signal ended it, Interrupted
    /// after Ctrl-C; none of its processes is left then.
    ColmapOutcome run(const ColmapStep& step) const;
    /// Throws ResourceError unless the step succeeded.
    void check(const ColmapStep& step, const ColmapOutcome& outcome) const;

    /// Adds "--NOW.use_gpu 0 --NOW.num_threads N", or BEFORE for NOW: COLMAP 3.13 renamed them, so
    /// the command's list of options decides. scratch: a file to be written.
    void add_device(ColmapStep& step, const std::string& now, const std::string& before,
                    const std::filesystem::path& scratch) const;

    int threads() const { return threads_; }

  private:
    std::filesystem::path program_, log_;
    int threads_;  ///< COLMAP's: -1 for one per core
};

}  // namespace item3d
