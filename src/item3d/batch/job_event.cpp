#include "item3d/batch/job_event.h"

#include "item3d/core/parse_json.h"

namespace item3d {

NLOHMANN_JSON_SERIALIZE_ENUM(JobState, {{JobState::waiting, "waiting"},
                                        {JobState::done, "done"},
                                        {JobState::failed, "failed"}})

void to_json(nlohmann::json& value, const JobEvent& event) {
    value = {{"job", event.job},         {"state", event.state},   {"worker", event.worker},
             {"attempt", event.attempt}, {"errors", event.errors}, {"deaths", event.deaths},
             {"seconds", event.seconds}};
    if (!event.message.empty()) value["message"] = event.message;
    if (!event.warnings.empty()) value["warnings"] = event.warnings;
    if (!event.outcome.is_null()) value["outcome"] = event.outcome;
}

void from_json(const nlohmann::json& value, JobEvent& event) {
    value.at("job").get_to(event.job);
    value.at("state").get_to(event.state);
    value.at("worker").get_to(event.worker);
    event.attempt = int_of(value.at("attempt"));
    event.errors = int_of(value.at("errors"));
    event.deaths = int_of(value.at("deaths"));
    value.at("seconds").get_to(event.seconds);
    event.message = value.value("message", std::string());
    event.warnings = value.value("warnings", std::vector<std::string>());
    event.outcome = value.value("outcome", nlohmann::json());
}

const char* state_name(JobState state) {
    switch (state) {
        case JobState::done:
            return "done";
        case JobState::failed:
            return "failed";
        case JobState::waiting:
            return "waiting";
    }
    return "";
}

}  // namespace item3d
