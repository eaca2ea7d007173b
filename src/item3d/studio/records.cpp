#include "item3d/studio/records.h"

#include "item3d/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace item3d {
namespace {

using Json = nlohmann::json;

constexpr std::array<std::pair<ResultState, const char*>, 6> states = {{
    {ResultState::waiting, "waiting"},
    {ResultState::running, "running"},
    {ResultState::paused, "paused"},
    {ResultState::done, "done"},
    {ResultState::failed, "failed"},
    {ResultState::cancelled, "cancelled"},
}};

}  // namespace

std::string state_name(ResultState state) {
    for (const auto& [value, name] : states)
        if (value == state) return name;
    ITEM3D_CHECK(false, "a state without a name");
}

ResultState parse_state(const std::string& name) {
    for (const auto& [value, known] : states)
        if (name == known) return value;
    throw InputError("state", "'" + name + "' is not a state of a result");
}

bool has_ended(ResultState state) {
    return state != ResultState::waiting && state != ResultState::running;
}

std::string text_of(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

Json project_json(const StudioProject& project) {
    return {{"id", project.id},           {"name", project.name},
            {"created", project.created}, {"modified", project.modified},
            {"results", project.results}, {"favourite", project.favourite}};
}

Json result_json(const StudioResult& result) {
    Json json = {{"id", result.id},
                 {"project", result.project},
                 {"parent", result.parent ? Json(*result.parent) : Json()},
                 {"kind", result.kind},
                 {"name", result.name},
                 {"from", text_of(result.request, "from")},
                 {"to", text_of(result.request, "to")},
                 {"settings", result.request.value("settings", Json::object())},
                 {"region", result.request.value("region", Json::array())},
                 {"request", result.request},
                 {"command", result.command},
                 {"state", state_name(result.state)},
                 {"progress", result.progress},
                 {"message", result.message},
                 {"created", result.created},
                 {"seconds", result.seconds},
                 {"scores", result.scores},
                 {"favourite", result.favourite},
                 {"note", result.note},
                 {"files", result.files}};
    const bool has_image =
        std::find(result.files.begin(), result.files.end(), thumbnail_name) != result.files.end();
    json["thumbnail"] =
        has_image ? fmt::format("api/results/{}/files/{}", result.id, thumbnail_name) : "";
    return json;
}

}  // namespace item3d
