// All jobs of a batch and what became of them, read from its folder step by step.
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
    /// The last line of a journal about it; `job` is empty where there was none.
    JobEvent last;
    int askers = 0;  ///< keys that mean it; 0: it was removed, or a later job took its place

    bool is_current() const { return askers > 0; }
    bool is_finished() const { return state != JobState::waiting; }
};

class BatchView {
  public:
    /// Reads all that is there.
    explicit BatchView(const BatchFolder& folder);

    /// Findings of refresh(): indices of jobs that are asked for now, in the order in which they
    /// were asked, and of those that a journal has told of.
    struct News {
        std::vector<std::size_t> added, told;
    };
    /// Reads what jobs and journals have grown by. A journal's line about a job that is done
    /// already changes nothing.
    News refresh();
    /// As if a journal had told it.
    void tell(const JobEvent& event);

    const std::vector<BatchEntry>& entries() const { return entries_; }
    const BatchEntry& entry(std::size_t index) const { return entries_[index]; }
    std::optional<std::size_t> find(const std::string& id) const;
    /// The job of a key, as it is now.
    std::optional<std::size_t> find_key(const std::string& key) const;
    /// All keys that mean a job now.
    std::vector<std::string> keys_of(std::size_t index) const;
    /// Current jobs that are neither done nor failed.
    std::size_t open_count() const { return open_; }

    /// Of jobs that no journal tells of, those whose folders are there: begun by somebody. Lists
    /// the folders of folders, not each job's own.
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
