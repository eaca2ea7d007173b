// Claims of jobs by workers. A worker claims a job by creating or renaming a folder.
//
//     (no folder)            not begun
//     empty                  being begun
//     attempt-N-WORKER/      the N-th attempt, by this worker
//     waiting-N/             released after N attempts: the next one continues from its contents
//     result/                done, final
//     failed/                failed for good
//
// mkdir() and rename() of a folder are atomic, also on file systems without hard links and on NFS,
// and rename() never replaces a non-empty folder. So only one worker begins a job, takes over an
// abandoned job, or publishes a result. A worker that was paused and lost its job meanwhile writes
// into a folder that no longer exists, and its rename() fails.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

enum class FolderState { absent, empty, running, waiting, done, failed };

/// State of a job's folder.
struct FolderLook {
    FolderState state = FolderState::absent;
    int attempt = 0;     ///< N above; only for running and waiting jobs
    std::string worker;  ///< only for running jobs
    /// The folder attempt-N-WORKER or waiting-N; only for running and waiting jobs.
    std::filesystem::path current;
};
FolderLook look_at(const std::filesystem::path& job_folder);

/// Claim of a job by this process.
class Claim {
  public:
    /// Begins the first attempt at a job; nullopt if another worker has begun it. Throws DiskFull
    /// or InputError if folders cannot be made.
    static std::optional<Claim> begin(const std::filesystem::path& job_folder,
                                      const std::string& worker);
    /// Begins a further attempt at a job that `look` found waiting, running or empty; nullopt if
    /// another worker was faster. The caller decides whether a running job may be taken over
    /// (worker_watch.h).
    static std::optional<Claim> take(const std::filesystem::path& job_folder,
                                     const FolderLook& look, const std::string& worker);

    int attempt() const { return attempt_; }
    /// Returns the folder in which the attempt works.
    const std::filesystem::path& folder() const { return folder_; }

    /// True if this process still holds the claim.
    bool is_held() const;
    /// Renames the attempt's folder to `result` or `failed`. Returns false, without effect, if the
    /// claim was lost or another worker has published.
    bool publish(FolderState state) const;
    /// Leaves the job and its files to other workers. Returns false if the claim was lost.
    bool release() const;

  private:
    Claim(std::filesystem::path job_folder, const std::string& worker, int attempt);
    std::filesystem::path job_folder_;
    std::filesystem::path folder_;
    int attempt_;
};

/// Returns the result folder of a finished job.
std::filesystem::path result_folder(const std::filesystem::path& job_folder);
/// Returns the folder of a failed job.
std::filesystem::path failed_folder(const std::filesystem::path& job_folder);

/// Makes a failed job wait again. Its number of attempts becomes `attempts` + 1. Returns false if
/// the job had not failed.
bool retry_failed(const std::filesystem::path& job_folder, int attempts);

}  // namespace item3d
