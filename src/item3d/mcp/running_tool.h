// A running command of a tool, and its result.
#pragma once

#include "item3d/core/child_program.h"
#include "item3d/mcp/tool_command.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace item3d {

/// Progress of a command in human-readable form.
struct ToolProgress {
    std::int64_t steps = 0;  ///< total of all stages so far; it only grows
    std::string message;     ///< "edit: 34 of 150, 12 s left"
};

class RunningTool {
  public:
    /// launcher: path of the program item3d; scratch: a folder for the command's log and progress,
    /// which the destructor removes.
    RunningTool(ToolCommand command, const std::filesystem::path& launcher,
                const std::filesystem::path& scratch);
    ~RunningTool();
    RunningTool(const RunningTool&) = delete;
    RunningTool& operator=(const RunningTool&) = delete;

    /// Returns the progress if it advanced since the last call.
    std::optional<ToolProgress> progress();
    /// Returns the result of tools/call after the command has ended: images and links to files, or
    /// its error.
    std::optional<nlohmann::json> result();
    /// Asks the command to write a checkpoint, if it can, and end.
    void cancel() { program_->ask_to_end(); }

  private:
    nlohmann::json success() const;

    ToolCommand command_;
    std::filesystem::path scratch_;
    std::unique_ptr<ChildProgram> program_;
    std::string stage_;
    std::int64_t before_ = 0, done_ = 0;  ///< steps of finished stages, and of the current one
};

/// Returns a result of tools/call with an error message.
nlohmann::json failed_call(const std::string& message);

}  // namespace item3d
