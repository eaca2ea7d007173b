#include "item3d/batch/job_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace item3d {

JobQueue::JobQueue(const BatchView& view, const std::string& version, std::size_t first_session)
    : view_(view), version_(version), first_session_(first_session) {}

void JobQueue::add(std::size_t index) {
    const BatchJob& job = view_.entry(index).job;
    if (job.version != version_) {
        foreign_.push_back(index);
        return;
    }
    if (!job.after.empty()) {
        const auto before = view_.find(job.after);
        const JobState state = before ? view_.entry(*before).state : JobState::waiting;
        if (state == JobState::failed) hopeless_.push_back(index);
        if (state == JobState::waiting) held_back_[job.after].push_back(index);
        if (state != JobState::done) return;
    }
    fresh_[job.session].push_back(index);
}

void JobQueue::finished(std::size_t index) {
    const auto found = held_back_.find(view_.entry(index).job.id);
    if (found == held_back_.end()) return;
    const std::vector<std::size_t> freed = std::exchange(found->second, {});
    held_back_.erase(found);
    for (const std::size_t job : freed)
        add(job);
}

bool JobQueue::is_open(std::size_t index) const {
    const BatchEntry& entry = view_.entry(index);
    return entry.is_current() && !entry.is_finished();
}

std::size_t JobQueue::open_foreign() const {
    return static_cast<std::size_t>(std::count_if(
        foreign_.begin(), foreign_.end(), [this](std::size_t index) { return is_open(index); }));
}

std::optional<std::size_t> JobQueue::next_of(std::deque<std::size_t>& queue) {
    while (!queue.empty()) {
        const std::size_t index = queue.front();
        queue.pop_front();
        if (is_open(index)) return index;
    }
    return std::nullopt;
}

/// Returns the queue of the current session, or of the next session if that queue is empty; null if
/// all are empty.
std::deque<std::size_t>* JobQueue::fresh_queue() {
    std::erase_if(fresh_, [](const auto& queue) { return queue.second.empty(); });
    if (fresh_.empty()) return nullptr;
    if (!has_session_) {
        has_session_ = true;
        session_ =
            std::next(fresh_.begin(), static_cast<std::ptrdiff_t>(first_session_ % fresh_.size()))
                ->first;
    }
    auto found = fresh_.lower_bound(session_);
    if (found == fresh_.end()) found = fresh_.begin();
    session_ = found->first;
    return &found->second;
}

std::optional<std::size_t> JobQueue::next() {
    if (const auto index = next_of(left_)) return index;
    while (std::deque<std::size_t>* queue = fresh_queue())
        if (const auto index = next_of(*queue)) return index;
    return next_of(retries_);
}

std::vector<std::size_t> JobQueue::take_hopeless() {
    return std::exchange(hopeless_, {});
}

}  // namespace item3d
