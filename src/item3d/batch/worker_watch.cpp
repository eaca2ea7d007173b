#include "item3d/batch/worker_watch.h"

#include "item3d/batch/process_mark.h"
#include "item3d/core/parse_json.h"

#include <fstream>
#include <sstream>

namespace item3d {
namespace {

/// True if those members of a heartbeat that `state` has are of the right types.
bool is_heartbeat(const nlohmann::json& state) {
    const auto fits = [&](const char* key, auto is_type) {
        const auto found = state.find(key);
        return found == state.end() || is_type(*found);
    };
    return state.is_object() && fits("ended", [](const auto& v) { return v.is_boolean(); }) &&
           fits("process", [](const auto& v) { return v.is_object() || v.is_null(); }) &&
           fits("job", [](const auto& v) { return v.is_string(); }) &&
           fits("beat", [](const auto& v) { return v.is_number_integer(); });
}

}  // namespace

nlohmann::json read_heartbeat(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) return nullptr;
    std::ostringstream text;
    text << file.rdbuf();
    nlohmann::json state = parse_json(text.str());
    return is_heartbeat(state) ? state : nlohmann::json();
}

bool WorkerWatch::is_lost(const std::string& job, const std::string& worker,
                          const std::string& sign, Clock::time_point now) {
    std::string shown = worker + " " + sign;
    if (!worker.empty()) {
        const nlohmann::json state = read_heartbeat(workers_ / (worker + ".json"));
        if (state.is_object()) {
            if (state.value("ended", false) || has_ended(state.value("process", nlohmann::json())))
                return true;
            // The heartbeat counts only if it is for this job.
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
