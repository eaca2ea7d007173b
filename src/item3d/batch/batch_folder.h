// The folder of a batch: its mark, its jobs, what workers say, and a folder for each job.
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
    /// Whether the folder is a batch's already. Throws InputError for one that holds something
    /// else, or a batch of a later version's layout.
    static bool is_begun(const std::filesystem::path& path);
    /// Makes the folder, or takes one that is a batch's already. Throws as is_begun(), and
    /// InputError where it cannot be written.
    static BatchFolder create(const std::filesystem::path& path);
    /// Throws InputError where there is no batch, or one of a later version's layout.
    static BatchFolder open(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path jobs() const { return path_ / "jobs"; }
    std::filesystem::path workers() const { return path_ / "workers"; }
    std::filesystem::path folder_of(const BatchJob& job) const { return path_ / job.folder; }

    /// Adds a file of jobs, whole or not at all. Several programs may add jobs at the same time.
    void add_jobs(const std::vector<BatchJob>& jobs) const;

    /// Adds a file of lines that take jobs out again, by their keys.
    void remove_jobs(const std::vector<std::string>& keys) const;

    /// Whether less than a megabyte is left for new files.
    bool is_full() const;

  private:
    explicit BatchFolder(std::filesystem::path path) : path_(std::move(path)) {}
    void add_lines(const std::string& lines) const;
    std::filesystem::path path_;
};

/// Member of a line among jobs that takes one out: {"removed": KEY}.
inline constexpr const char* removed_key = "removed";

/// Four hexadecimal digits that no other process of the batch is likely to draw as well.
std::string random_suffix();

}  // namespace item3d
