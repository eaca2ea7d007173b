// The order in which a worker tries to claim jobs.
#pragma once

#include "item3d/batch/batch_view.h"

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace item3d {

/// Queue of jobs in three parts. Abandoned jobs come first. New jobs follow in the order of
/// addition, grouped by BatchJob::session so that networks are loaded once. Jobs that ended with an
/// error come last. A job with a predecessor is held back until the predecessor is done.
class JobQueue {
  public:
    /// version: the program's; jobs of other versions are left out. first_session: a number that
    /// selects the first session; it differs between workers, so that they start with different
    /// sessions.
    JobQueue(const BatchView& view, const std::string& version, std::size_t first_session);

    /// Adds a job that no worker is known to have begun.
    void add(std::size_t index);
    /// Adds a job that was released, or whose worker was lost.
    void add_left(std::size_t index) { left_.push_back(index); }
    /// Adds a job that ended with an error and may be retried.
    void add_retry(std::size_t index) { retries_.push_back(index); }
    /// Continues after a job has ended. The jobs that waited for it join the queue, or become
    /// hopeless if it failed.
    void finished(std::size_t index);

    /// Removes and returns the next job that is current and not finished.
    std::optional<std::size_t> next();
    /// Removes and returns the jobs whose predecessor failed.
    std::vector<std::size_t> take_hopeless();
    /// Returns the number of open jobs that another version of the program planned.
    std::size_t open_foreign() const;

  private:
    bool is_open(std::size_t index) const;
    std::optional<std::size_t> next_of(std::deque<std::size_t>& queue);
    std::deque<std::size_t>* fresh_queue();

    const BatchView& view_;
    std::string version_;
    std::size_t first_session_;
    std::vector<std::size_t> foreign_;
    std::map<std::string, std::deque<std::size_t>> fresh_;  ///< by session
    std::string session_;                                   ///< session of the jobs being taken
    bool has_session_ = false;
    std::deque<std::size_t> left_, retries_;
    std::unordered_map<std::string, std::vector<std::size_t>> held_back_;  ///< by predecessor's id
    std::vector<std::size_t> hopeless_;
};

}  // namespace item3d
