// What changed, for the pages that are open: server-sent events that can be asked for again.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

namespace item3d {

/// Thread-safe. Keeps the last events in memory. Ids rise, also from one run of the server to the
/// next.
class StudioEvents {
  public:
    StudioEvents();

    /// Sends an event to all pages. Of events of one `key` ("preview 7") the last alone is kept for
    /// those who ask again; empty: each is kept.
    void send(const std::string& event, const nlohmann::json& data, const std::string& key = "");
    /// Events behind `after` in the format of text/event-stream, and `after` set to the last one's
    /// id; blocks until there is one, or `longest` has passed (then a comment, which keeps proxies
    /// from closing the connection). Begins with "event: reset" where events behind `after` are no
    /// longer kept, or are another server's.
    std::string wait(std::int64_t& after, std::chrono::milliseconds longest);
    /// The last event's id.
    std::int64_t last() const;
    /// Ends all waiting, at once and for ever.
    void close();
    bool is_closed() const;

  private:
    struct Event {
        std::int64_t id = 0;
        std::string key;
        std::string text;
    };

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Event> events_;
    std::int64_t first_ = 0;  ///< events behind this id are kept, but for replaced ones
    std::int64_t last_ = 0;
    bool closed_ = false;
};

}  // namespace item3d
