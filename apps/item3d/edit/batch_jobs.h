// Jobs of a batch, edits and relightings, run one after another in one process.
#pragma once

#include "item3d/batch/attempt.h"
#include "item3d/batch/columns.h"
#include "item3d/edit/session.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// `edit` and `relight` with all their options but those that a batch decides itself (output,
/// threads, resume, ...).
std::vector<JobCommand> job_commands();

/// Throws UsageError or InputError where the command would refuse these options before it loads
/// anything.
void check_job(const std::string& command, const std::vector<std::string>& arguments);

/// Identity of a prior, the embedded one for "": hashes of its weights and settings. Throws
/// InputError.
std::string identity_of_prior(const std::string& prior);

/// Runs jobs one after another in this process: those of one session (BatchJob) share networks.
class JobProcess {
  public:
    explicit JobProcess(bool quiet) : quiet_(quiet) {}

    /// Returns {"scores", "seconds", "peak_memory_bytes"}, as far as the command has them. Throws
    /// as the commands do, and InputError where the model's file is not the one that the job was
    /// planned with.
    nlohmann::json run(const ClaimedJob& job);

  private:
    bool quiet_;
    std::string session_name_;
    std::unique_ptr<EditSession> session_;
};

}  // namespace item3d
