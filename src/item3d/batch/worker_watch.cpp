#include "item3d/batch/worker_watch.h"

#include "item3d/batch/process_mark.h"

#include <fstream>
#include <sstream>

namespace item3d {

nlohmann::json read_heartbeat(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) return nullptr;
    std::ostringstream text;
    text << file.rdbuf();
    nlohmann::json state = nlohmann::json::parse(text.str(), nullptr, false);
    return state.is_object() ? state : nlohmann::json();
}

bool WorkerWatch::is_lost(const std::string& job, const std::string& worker,
                          const std::string& sign, Clock::time_point now) {
    std::string shown = worker + " " + sign;
    if (!worker.empty()) {
        const nlohmann::json state = read_heartbeat(workers_ / (worker + ".json"));
        if (state.is_object()) {
            if (state.value("ended", false) || has_ended(state.value("process", nlohmann::json())))
                return true;
            // Only a heartbeat for this job counts.
            if (state.value("job", "") == job)
                shown += " " + std::to_string(state.value("beat", std::int64_t(0)));
        }
    }
    const auto [found, is_new] = seen_.try_emplace(job, Seen{shown, now});
    if (is_new || found->second.sign == shown) return now - found->second.since > stale_after_;
    found->second = {shown, now};
    return false;
}

}  // namespace item3d
