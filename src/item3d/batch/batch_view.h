// All jobs of a batch and their states, read incrementally from its folder.
#pragma once

#include "item3d/batch/batch_folder.h"
#include "item3d/batch/job_event.h"
#include "item3d/batch/line_file.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace item3d {

struct BatchEntry {
    BatchJob job;
    JobState state = JobState::waiting;
    /// Last journal line about the job; its member `job` is empty if there is none.
    JobEvent last;
    /// Number of job keys (BatchJob::key) that refer to the job; 0 if it was removed or replaced.
    int askers = 0;

    bool is_current() const { return askers > 0; }
    bool is_finished() const { return state != JobState::waiting; }
};

class BatchView {
  public:
    /// Reads the whole folder.
    explicit BatchView(const BatchFolder& folder);

    /// Result of refresh(). `added` has the indices of the new current jobs, in the order of their
    /// addition. `told` has the indices of the jobs with new journal lines. A job is current unless
    /// it was removed or replaced.
    struct News {
        std::vector<std::size_t> added, told;
    };
    /// Reads new lines of the job files and of the journals. Ignores journal lines about jobs that
    /// are already done.
    News refresh();
    /// Applies an event as if it were read from a journal.
    void tell(const JobEvent& event);

    const std::vector<BatchEntry>& entries() const { return entries_; }
    const BatchEntry& entry(std::size_t index) const { return entries_[index]; }
    std::optional<std::size_t> find(const std::string& id) const;
    /// Returns the current job of a key.
    std::optional<std::size_t> find_key(const std::string& key) const;
    /// Returns all keys that refer to a job.
    std::vector<std::string> keys_of(std::size_t index) const;
    /// Number of current jobs that are neither done nor failed.
    std::size_t open_count() const { return open_; }

    /// Returns the jobs that a worker has begun: their folders exist, but they have no journal
    /// line. Lists only the parent folders, not the folder of each job.
    std::vector<std::size_t> begun() const;

  private:
    std::optional<std::size_t> add(BatchJob job);
    void remove(const std::string& key);
    void count(std::size_t index, int askers);
    bool take(const JobEvent& event);

    BatchFolder folder_;
    AddedLines jobs_, journals_;
    std::vector<BatchEntry> entries_;
    std::unordered_map<std::string, std::size_t> by_id_, by_key_;
    std::size_t open_ = 0;
};

}  // namespace item3d
