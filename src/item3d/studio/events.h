// Change notifications for open pages. They are server-sent events that can be requested again.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

namespace item3d {

/// Event queue. Thread-safe. Keeps the last events in memory. Ids increase, also across restarts of
/// the server.
class StudioEvents {
  public:
    StudioEvents();

    /// Sends an event to all pages. Only the last event with the same `key`, such as "preview 7",
    /// is kept for later requests. Events with an empty key are all kept.
    void send(const std::string& event, const nlohmann::json& data, const std::string& key = "");
    /// Returns the events after id `after` in the format of text/event-stream, and sets `after` to
    /// the id of the last one. Blocks until there is an event. If `longest` passes before, it
    /// returns a comment, which keeps proxies from closing the connection. Returns "event: reset"
    /// instead if events after `after` are no longer kept, or if `after` is an id of another
    /// server.
    std::string wait(std::int64_t& after, std::chrono::milliseconds longest);
    /// Returns the id of the last event.
    std::int64_t last() const;
    /// Ends all waiting calls, present and future.
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
    std::int64_t first_ = 0;  ///< events after this id are kept, except those that were replaced
    std::int64_t last_ = 0;
    bool closed_ = false;
};

}  // namespace item3d
