// Which job a worker tries to claim next.
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

/// Jobs as they were asked for, those of one session together, so that networks are loaded once;
/// those that others left before them, those that ended with an error after them. A job that comes
/// after another is held back until that one is done.
class JobQueue {
  public:
    /// first_session: a number that differs from worker to worker: with several sessions, workers
    /// begin at different ones.
    JobQueue(const BatchView& view, const std::string& version, std::size_t first_session);

    /// A job that nobody is known to have begun.
    void add(std::size_t index);
    /// One that was released, or whose worker was lost.
    void add_left(std::size_t index) { left_.push_back(index); }
    /// One that ended with an error and may be tried again.
    void add_retry(std::size_t index) { retries_.push_back(index); }
    /// Jobs that waited for this one are free, or, where it failed, lost.
    void finished(std::size_t index);

    /// The next job that is current and not finished; it leaves the queue.
    std::optional<std::size_t> next();
    /// Jobs whose predecessor failed; they leave the queue.
    std::vector<std::size_t> take_hopeless();
    /// Jobs that are open and were planned by another version of the program.
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
    std::string session_;                                   ///< the one that jobs are taken of
    bool has_session_ = false;
    std::deque<std::size_t> left_, retries_;
    std::unordered_map<std::string, std::vector<std::size_t>> held_back_;  ///< by predecessor's id
    std::vector<std::size_t> hopeless_;
};

}  // namespace item3d
