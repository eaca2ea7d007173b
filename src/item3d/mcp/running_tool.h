// A tool's command while it runs, and what it left.
#pragma once

#include "item3d/core/child_program.h"
#include "item3d/mcp/tool_command.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace item3d {

/// How far a command is, for people.
struct ToolProgress {
    std::int64_t steps = 0;  ///< of all stages so far; rises
    std::string message;     ///< "edit: 34 of 150, 12 s left"
};

class RunningTool {
  public:
    /// launcher: item3d; scratch: a folder for its log and progress, which is removed with this.
    RunningTool(ToolCommand command, const std::filesystem::path& launcher,
                const std::filesystem::path& scratch);
    ~RunningTool();
    RunningTool(const RunningTool&) = delete;
    RunningTool& operator=(const RunningTool&) = delete;

    /// Where it has got further since the last time.
    std::optional<ToolProgress> progress();
    /// Once it has ended: the result of tools/call, with pictures and links to files, or its error.
    std::optional<nlohmann::json> result();
    /// It writes a checkpoint, where its command has one, and ends.
    void cancel() { program_->ask_to_end(); }

  private:
    nlohmann::json success() const;

    ToolCommand command_;
    std::filesystem::path scratch_;
    std::unique_ptr<ChildProgram> program_;
    std::string stage_;
    std::int64_t before_ = 0, done_ = 0;  ///< steps of stages that have ended, and of this one
};

/// A result of tools/call that says what went wrong.
nlohmann::json failed_call(const std::string& message);

}  // namespace item3d
