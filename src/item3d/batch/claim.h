// Who works at a job: folders that are made and renamed, which one process alone can do.
//
//     (no folder)            nobody has begun it
//     empty                  somebody is about to
//     attempt-N-WORKER/      the N-th attempt, by this worker
//     waiting-N/             released after N attempts: the next one goes on from what is there
//     result/                done; nobody changes it any more
//     failed/                given up
//
// mkdir() and rename() of a folder are atomic, also on file systems without hard links and on NFS,
// and rename() never replaces a folder that holds something. So one worker alone begins a job,
// takes over what another left, and publishes; a worker that lost its job while it was stopped
// writes into a folder that is not there any more, and its rename() fails.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

enum class FolderState { absent, empty, running, waiting, done, failed };

/// What a job's folder says.
struct FolderLook {
    FolderState state = FolderState::absent;
    int attempt = 0;                ///< of running and waiting: N
    std::string worker;             ///< of running
    std::filesystem::path current;  ///< the folder within, of running and waiting
};
FolderLook look_at(const std::filesystem::path& job_folder);

/// A job that this process works at.
class Claim {
  public:
    /// The first attempt at a job that nobody has begun; nothing where somebody has. Throws
    /// DiskFull or InputError where folders cannot be made.
    static std::optional<Claim> begin(const std::filesystem::path& job_folder,
                                      const std::string& worker);
    /// A further attempt, at what `look` found waiting, running or empty; nothing where another was
    /// faster. Whether a running job may be taken over is for the caller to know
    /// (worker_watch.h).
    static std::optional<Claim> take(const std::filesystem::path& job_folder,
                                     const FolderLook& look, const std::string& worker);

    int attempt() const { return attempt_; }
    /// Where the attempt works.
    const std::filesystem::path& folder() const { return folder_; }

    /// Whether it is still this process's.
    bool is_held() const;
    /// Makes the attempt's folder `result` or `failed`, with all that is in it. False where the
    /// claim was lost or another has published; nothing is changed then.
    bool publish(FolderState state) const;
    /// Leaves the job to others, with what is there. False where the claim was lost.
    bool release() const;

  private:
    Claim(std::filesystem::path job_folder, const std::string& worker, int attempt);
    std::filesystem::path job_folder_;
    std::filesystem::path folder_;
    int attempt_;
};

/// The folder of a job that is done.
std::filesystem::path result_folder(const std::filesystem::path& job_folder);
/// The folder of one that was given up.
std::filesystem::path failed_folder(const std::filesystem::path& job_folder);

/// Makes a job that was given up after `attempts` of them wait again, as if after one more. False
/// where it was not.
bool retry_failed(const std::filesystem::path& job_folder, int attempts);

}  // namespace item3d
