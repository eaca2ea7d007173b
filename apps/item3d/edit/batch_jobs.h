// The runner of a batch's jobs (edits and relightings) in one process.
#pragma once

#include "item3d/batch/attempt.h"
#include "item3d/batch/columns.h"
#include "item3d/edit/session.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Returns `edit` and `relight` with all their options except those that a batch sets itself
/// (output, threads, resume, ...).
std::vector<JobCommand> job_commands();

/// Throws UsageError or InputError if the command would refuse these options before it loads
/// anything.
void check_job(const std::string& command, const std::vector<std::string>& arguments);

/// Returns the identity of a prior, which has hashes of its weights and settings. prior: "" for the
/// embedded prior. Throws InputError.
std::string identity_of_prior(const std::string& prior);

/// Runner of jobs, one after another. Jobs of one session (BatchJob::session) share networks.
class JobProcess {
  public:
    explicit JobProcess(bool quiet) : quiet_(quiet) {}

    /// Runs a job. Returns those of "scores", "seconds" and "peak_memory_bytes" that the command
    /// has. Throws like the commands, and InputError if the model's file has changed since the job
    /// was planned.
    nlohmann::json run(const ClaimedJob& job);

  private:
    bool quiet_;
    std::string session_name_;
    std::unique_ptr<EditSession> session_;
};

}  // namespace item3d
