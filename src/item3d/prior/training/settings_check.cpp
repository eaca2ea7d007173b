#include "item3d/prior/training/settings_check.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"

namespace item3d {

std::string changed_settings(const nlohmann::json& before, const nlohmann::json& now) {
    std::string changes;
    for (const auto& [name, value] : now.items()) {
        if (!before.contains(name) || before.at(name) == value) continue;
        changes += fmt::format("{}{}: {} instead of {}", changes.empty() ? "" : ", ", name,
                               value.dump(), before.at(name).dump());
    }
    return changes;
}

double as_written(float value) {
    return std::stod(fmt::format("{}", value));
}

void check_settings(const std::filesystem::path& file, const nlohmann::json& before,
                    const nlohmann::json& now) {
    if (!before.is_object())
        throw InputError(file.string(), "does not say what it was made with",
                         "train without --resume, or in another --work folder");
    const std::string changes = changed_settings(before, now);
    if (!changes.empty())
        throw InputError(file.string(), "was made with other settings: " + changes,
                         "give the same ones, or train in another --work folder");
}

nlohmann::json read_work_json(const std::filesystem::path& file) {
    nlohmann::json json = nlohmann::json::parse(read_text(file), nullptr, false);
    if (!json.is_object())
        throw InputError(file.string(), "is not a JSON object",
                         "train without --resume, or in another --work folder");
    return json;
}

void check_same_settings(const ProcessGroup& processes, const nlohmann::json& settings) {
    const auto first = nlohmann::json::parse(processes.broadcast(settings.dump()));
    const std::string changes = changed_settings(first, settings);
    if (!changes.empty())
        throw InputError(fmt::format("process {} of {}", processes.rank(), processes.size()),
                         "has other settings than process 0: " + changes,
                         "give all of them the same options");
}

}  // namespace item3d
