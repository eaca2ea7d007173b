// Projects and results of the studio, and their JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// A model that somebody opened.
struct StudioProject {
    std::int64_t id = 0;
    std::string name;      ///< as people see it
    std::string file;      ///< of the model in the project's folder source/; empty: none yet
    std::string created;   ///< UTC, ISO 8601
    std::string modified;  ///< of the project or its results
    bool favourite = false;
    /// "format", "triangles", "materials", "nodes", "has_uv", "warnings" (ModelFacts).
    nlohmann::json model = nlohmann::json::object();
    std::int64_t results = 0;  ///< how many there are
};

enum class ResultState { waiting, running, paused, done, failed, cancelled };

std::string state_name(ResultState state);
/// Throws InputError for another name.
ResultState parse_state(const std::string& name);
/// Whether it is neither waiting nor running.
bool has_ended(ResultState state);

/// A command that makes something of a project's model: an edit, another light, a reconstruction.
struct StudioResult {
    std::int64_t id = 0;
    std::int64_t project = 0;
    std::optional<std::int64_t> parent;  ///< the result whose model it begins with
    std::string kind = "edit";           ///< edit, relight or reconstruct
    std::string name;                    ///< given by people; empty: none
    /// What was asked for: "from", "to", "settings", "region", ... of the request.
    nlohmann::json request = nlohmann::json::object();
    ResultState state = ResultState::waiting;
    std::string message;  ///< why it failed, whole
    std::string created;  ///< UTC, ISO 8601
    double seconds = 0;   ///< that its programs ran
    nlohmann::json scores = nlohmann::json::object();
    bool favourite = false;
    std::string note;
    std::vector<std::string> files;  ///< that can be asked for, once it has ended
    std::string command;             ///< that makes it on the command line
    nlohmann::json progress;         ///< while it runs (docs/reference/studio_api.md)
};

nlohmann::json project_json(const StudioProject& project);
nlohmann::json result_json(const StudioResult& result);

/// A small picture among a result's files.
inline constexpr const char* thumbnail_name = "thumbnail.jpg";

/// The object's text under that key; empty where there is none.
std::string text_of(const nlohmann::json& object, const char* key);

}  // namespace item3d
