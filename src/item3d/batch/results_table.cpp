#include "item3d/batch/results_table.h"

#include "item3d/core/csv.h"
#include "item3d/core/format.h"

#include <set>

namespace item3d {
namespace {

using nlohmann::json;

/// Returns the numbers of a JSON object by name. Names of nested numbers are paths such as
/// "scores.clip.global".
std::map<std::string, std::string> numbers_of(const json& value, const std::string& path) {
    std::map<std::string, std::string> numbers;
    if (value.is_number()) numbers[path] = value.dump();
    if (!value.is_structured()) return numbers;
    std::size_t place = 0;
    for (const auto& [key, inner] : value.items()) {
        const std::string name = value.is_array() ? std::to_string(place++) : key;
        numbers.merge(numbers_of(inner, path + "." + name));
    }
    return numbers;
}

json scores_of(const BatchEntry& entry) {
    const json& outcome = entry.last.outcome;
    return outcome.is_object() ? outcome.value("scores", json::object()) : json::object();
}

std::string quoted_options(const BatchJob& job) {
    std::string text;
    for (const std::string& argument : job.arguments)
        text += (text.empty() ? "" : " ") + argument;
    return text;
}

}  // namespace

std::string results_csv(const BatchView& view) {
    std::set<std::string> names;
    for (const BatchEntry& entry : view.entries())
        for (const auto& [name, value] : numbers_of(scores_of(entry), "scores"))
            names.insert(name);
    std::vector<std::string> header = {"name",   "model",   "from",    "to",       "command",
                                       "state",  "message", "folder",  "attempts", "seconds",
                                       "worker", "options", "warnings"};
    header.insert(header.end(), names.begin(), names.end());
    std::string text = csv_line(header);
    for (const BatchEntry& entry : view.entries()) {
        if (!entry.is_current()) continue;
        const BatchJob& job = entry.job;
        const std::string within = entry.state == JobState::done     ? "/result"
                                   : entry.state == JobState::failed ? "/failed"
                                                                     : "";
        std::vector<std::string> line = {job.name,
                                         job.model,
                                         job.from,
                                         job.to,
                                         job.command,
                                         state_name(entry.state),
                                         entry.last.message,
                                         job.folder + within,
                                         std::to_string(entry.last.attempt),
                                         fmt::format("{:.1f}", entry.last.seconds),
                                         entry.last.worker,
                                         quoted_options(job),
                                         fmt::format("{}", fmt::join(entry.last.warnings, "\n"))};
        const auto numbers = numbers_of(scores_of(entry), "scores");
        for (const std::string& name : names)
            line.push_back(numbers.contains(name) ? numbers.at(name) : "");
        text += csv_line(line);
    }
    return text;
}

}  // namespace item3d
