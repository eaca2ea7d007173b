// The end of an attempt at a job, as a line of a worker's journal and a file beside the results.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

enum class JobState { waiting, done, failed };

struct JobEvent {
    std::string job;  ///< id
    JobState state = JobState::waiting;
    std::string worker;
    int attempt = 0;                    ///< the how manieth start this was
    int errors = 0;                     ///< attempts that ended with an error
    int deaths = 0;                     ///< attempts whose worker ended without a word
    double seconds = 0;                 ///< of the last attempt
    std::string message;                ///< of the last error
    std::vector<std::string> warnings;  ///< of all attempts, each once
    nlohmann::json outcome;  ///< what the run says of itself: scores, seconds by stage; may be null
};

void to_json(nlohmann::json& value, const JobEvent& event);
/// Throws nlohmann::json::exception for what is no event.
void from_json(const nlohmann::json& value, JobEvent& event);

/// "waiting", "done", "failed".
const char* state_name(JobState state);

}  // namespace item3d
