// The folder of a batch. It has a file that marks it, the jobs, the workers' files, and a folder
// for each job.
//
//     batch.json                     marks the folder
//     jobs/000001-3f9a.jsonl         jobs, a line each, or {"removed": KEY}; a file for each change
//     workers/WORKER.json            heartbeat of a worker
//     workers/WORKER.jsonl           its journal: a line for each job that it finished or released
//     runs/AB/MODEL-SENTENCE-ID/     a job (claim.h)
#pragma once

#include "item3d/batch/job.h"

#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

class BatchFolder {
  public:
    /// True if the folder already contains a batch. Throws InputError for a folder with other
    /// contents, or a batch of a later layout version.
    static bool is_begun(const std::filesystem::path& path);
    /// Creates the folder, or opens one that contains a batch. Throws like is_begun(), and
    /// InputError if it cannot be written.
    static BatchFolder create(const std::filesystem::path& path);
    /// Opens the folder. Throws InputError if it has no batch, or a batch of a later layout
    /// version.
    static BatchFolder open(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path jobs() const { return path_ / "jobs"; }
    std::filesystem::path workers() const { return path_ / "workers"; }
    std::filesystem::path folder_of(const BatchJob& job) const { return path_ / job.folder; }

    /// Adds a file of jobs atomically. Several programs may add jobs at the same time.
    void add_jobs(const std::vector<BatchJob>& jobs) const;

    /// Adds a file of lines that remove jobs by their keys.
    void remove_jobs(const std::vector<std::string>& keys) const;

    /// True if less than a megabyte is left for new files.
    bool is_full() const;

  private:
    explicit BatchFolder(std::filesystem::path path) : path_(std::move(path)) {}
    void add_lines(const std::string& lines) const;
    std::filesystem::path path_;
};

/// The key of a line in jobs/ that removes a job: {"removed": KEY}.
inline constexpr const char* removed_key = "removed";

/// Returns four random hexadecimal digits, probably unique among the batch's processes.
std::string random_suffix();

}  // namespace item3d
