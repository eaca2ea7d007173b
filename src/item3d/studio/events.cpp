#include "item3d/studio/events.h"

#include <fmt/format.h>

#include <algorithm>

namespace item3d {
namespace {

constexpr std::size_t kept_events = 1000;

/// Returns the first id of this server. It is larger than any id of an earlier server, however many
/// events that server sent.
std::int64_t first_id() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

StudioEvents::StudioEvents() : first_(first_id()), last_(first_) {}

void StudioEvents::send(const std::string& event, const nlohmann::json& data,
                        const std::string& key) {
    const std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const std::lock_guard guard(mutex_);
    if (!key.empty()) std::erase_if(events_, [&](const Event& old) { return old.key == key; });
    ++last_;
    events_.push_back(
        {last_, key, fmt::format("id: {}\nevent: {}\ndata: {}\n\n", last_, event, text)});
    while (events_.size() > kept_events) {
        first_ = events_.front().id;
        events_.pop_front();
    }
    changed_.notify_all();
}

std::string StudioEvents::wait(std::int64_t& after, std::chrono::milliseconds longest) {
    std::unique_lock lock(mutex_);
    const bool is_known = after >= first_ && after <= last_;
    if (!is_known) {
        after = last_;
        return fmt::format("id: {}\nevent: reset\ndata: {{}}\n\n", last_);
    }
    changed_.wait_for(lock, longest, [&] { return closed_ || last_ > after; });
    std::string text;
    for (const Event& event : events_)
        if (event.id > after) text += event.text;
    after = last_;
    return text.empty() ? ": still here\n\n" : text;
}

std::int64_t StudioEvents::last() const {
    const std::lock_guard guard(mutex_);
    return last_;
}

void StudioEvents::close() {
    const std::lock_guard guard(mutex_);
    closed_ = true;
    changed_.notify_all();
}

bool StudioEvents::is_closed() const {
    const std::lock_guard guard(mutex_);
    return closed_;
}

}  // namespace item3d
