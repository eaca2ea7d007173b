// Records of the studio's projects and results, and their JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Project: a model that a user opened.
struct StudioProject {
    std::int64_t id = 0;
    std::string name;  ///< name that users see
    /// Model's file in the project's folder source/; empty if there is none yet.
    std::string file;
    std::string created;   ///< UTC, ISO 8601
    std::string modified;  ///< time of the last change of the project or its results
    bool favourite = false;
    /// Facts of write_model_summary().
    nlohmann::json model = nlohmann::json::object();
    std::int64_t results = 0;  ///< number of results
};

enum class ResultState { waiting, running, paused, done, failed, cancelled };

std::string state_name(ResultState state);
/// Returns the state of a name. Throws InputError for an unknown name.
ResultState parse_state(const std::string& name);
/// True if the state is neither waiting nor running.
bool has_ended(ResultState state);

/// Result of a command on a project's model: an edit, another light, a reconstruction.
struct StudioResult {
    std::int64_t id = 0;
    std::int64_t project = 0;
    std::optional<std::int64_t> parent;  ///< result whose model is the input
    std::string kind = "edit";           ///< edit, relight or reconstruct
    std::string name;                    ///< name that users gave; may be empty
    /// Request: "from", "to", "settings", "region", ...
    nlohmann::json request = nlohmann::json::object();
    ResultState state = ResultState::waiting;
    std::string message;  ///< complete error message
    std::string created;  ///< UTC, ISO 8601
    double seconds = 0;   ///< run time of the result's programs
    nlohmann::json scores = nlohmann::json::object();
    bool favourite = false;
    std::string note;
    std::vector<std::string> files;  ///< downloadable files, once the command has ended
    std::string command;             ///< equivalent command line
    /// Set only while the command runs (docs/reference/studio_api.md).
    nlohmann::json progress;
};

nlohmann::json project_json(const StudioProject& project);
nlohmann::json result_json(const StudioResult& result);

/// Name of the thumbnail among a result's files.
inline constexpr const char* thumbnail_name = "thumbnail.jpg";

/// Returns the object's text under the key; empty if there is none.
std::string text_of(const nlohmann::json& object, const char* key);

}  // namespace item3d
