// Runner of the steps of the COLMAP program. It shows their progress and reports failures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

struct ColmapStep {
    std::string label;       ///< label of the progress
    std::string counted;     ///< text that occurs in an output line for each of the `total` items
    std::int64_t total = 0;  ///< number of images, or of pairs of images
    std::string command;     ///< COLMAP's command, such as "mapper"
    std::vector<std::string> arguments;
};

/// Outcome of a step that was not ended by a signal.
struct ColmapOutcome {
    int exit_code = 0;
    std::string telling;  ///< output line that states the error
};

class ColmapProgram {
  public:
    /// program: path of COLMAP. log: file to which COLMAP's output is appended. threads: number of
    /// threads; with 0, COLMAP chooses the number.
    ColmapProgram(std::filesystem::path program, std::filesystem::path log, int threads);

    /// Runs a step and shows its progress. Throws ResourceError if a signal ended the step, and
    /// Interrupted after Ctrl-C. In both cases no process of COLMAP is left.
    ColmapOutcome run(const ColmapStep& step) const;
    /// Throws ResourceError unless the step succeeded.
    void check(const ColmapStep& step, const ColmapOutcome& outcome) const;

    /// Adds the options "--NOW.use_gpu 0 --NOW.num_threads N" to the step, with the prefix `now` or
    /// `before` in place of NOW. COLMAP 3.13 renamed these options, so the prefix is the one that
    /// the command's help text has. scratch: file to which the help text is written.
    void add_device(ColmapStep& step, const std::string& now, const std::string& before,
                    const std::filesystem::path& scratch) const;

    int threads() const { return threads_; }

  private:
    std::filesystem::path program_, log_;
    int threads_;  ///< value for COLMAP; -1 means one per core
};

}  // namespace item3d
