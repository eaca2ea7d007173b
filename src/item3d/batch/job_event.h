// The outcome of an attempt at a job. It is stored as a line of a worker's journal and as a file
// beside the results.
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
    int attempt = 0;                    ///< number of this attempt, from 1
    int errors = 0;                     ///< number of attempts that ended with an error
    int deaths = 0;                     ///< number of attempts whose worker died
    double seconds = 0;                 ///< duration of the last attempt
    std::string message;                ///< message of the last error
    std::vector<std::string> warnings;  ///< warnings of all attempts, each once
    nlohmann::json outcome;  ///< result of the run: scores, seconds by stage; may be null
};

void to_json(nlohmann::json& value, const JobEvent& event);
/// Throws nlohmann::json::exception for an invalid event.
void from_json(const nlohmann::json& value, JobEvent& event);

/// Returns "waiting", "done" or "failed".
const char* state_name(JobState state);

}  // namespace item3d
