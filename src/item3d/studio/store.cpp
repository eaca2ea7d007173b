#include "item3d/studio/store.h"

#include "item3d/core/error.h"
#include "item3d/core/parse_json.h"

#include <fmt/format.h>

namespace item3d {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t schema_version = 1;
constexpr const char* now = "strftime('%Y-%m-%dT%H:%M:%SZ', 'now')";

constexpr const char* schema = R"(
CREATE TABLE projects(
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    name TEXT NOT NULL,
    file TEXT NOT NULL DEFAULT '',
    created TEXT NOT NULL,
    modified TEXT NOT NULL,
    favourite INTEGER NOT NULL DEFAULT 0,
    model TEXT NOT NULL DEFAULT '{}');
CREATE TABLE results(
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    project INTEGER NOT NULL REFERENCES projects(id) ON DELETE CASCADE,
    parent INTEGER REFERENCES results(id) ON DELETE SET NULL,
    kind TEXT NOT NULL,
    name TEXT NOT NULL DEFAULT '',
    request TEXT NOT NULL,
    command TEXT NOT NULL,
    state TEXT NOT NULL,
    message TEXT NOT NULL DEFAULT '',
    created TEXT NOT NULL,
    seconds REAL NOT NULL DEFAULT 0,
    scores TEXT NOT NULL DEFAULT '{}',
    favourite INTEGER NOT NULL DEFAULT 0,
    note TEXT NOT NULL DEFAULT '',
    files TEXT NOT NULL DEFAULT '[]');
CREATE INDEX results_of_project ON results(project);
CREATE INDEX results_by_state ON results(state);
)";

constexpr const char* project_columns =
    "id, name, file, created, modified, favourite, model, "
    "(SELECT count(*) FROM results WHERE project = projects.id)";
constexpr const char* result_columns =
    "id, project, parent, kind, name, request, command, state, message, created, seconds, scores, "
    "favourite, note, files";

/// Parses JSON text of the database. Returns `otherwise` if the text is not JSON of the same type.
Json parsed(const std::string& text, Json otherwise) {
    Json json = parse_json(text);
    return json.type() == otherwise.type() ? json : otherwise;
}

std::vector<std::string> parsed_texts(const std::string& text) {
    std::vector<std::string> texts;
    for (const Json& value : parsed(text, Json::array()))
        if (value.is_string()) texts.push_back(value.get<std::string>());
    return texts;
}

std::string written(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

StudioProject read_project(const SqliteRows& rows) {
    StudioProject project;
    project.id = rows.number(0);
    project.name = rows.text(1);
    project.file = rows.text(2);
    project.created = rows.text(3);
    project.modified = rows.text(4);
    project.favourite = rows.number(5) != 0;
    project.model = parsed(rows.text(6), Json::object());
    project.results = rows.number(7);
    return project;
}

StudioResult read_result(const SqliteRows& rows) {
    StudioResult result;
    result.id = rows.number(0);
    result.project = rows.number(1);
    if (!rows.text(2).empty()) result.parent = rows.number(2);
    result.kind = rows.text(3);
    result.name = rows.text(4);
    result.request = parsed(rows.text(5), Json::object());
    result.command = rows.text(6);
    result.state = parse_state(rows.text(7));
    result.message = rows.text(8);
    result.created = rows.text(9);
    result.seconds = rows.real(10);
    result.scores = parsed(rows.text(11), Json::object());
    result.favourite = rows.number(12) != 0;
    result.note = rows.text(13);
    result.files = parsed_texts(rows.text(14));
    return result;
}

void touch(Sqlite& database, std::int64_t project) {
    SqliteRows rows(database, fmt::format("UPDATE projects SET modified = {} WHERE id = ?", now));
    rows.bind(project);
    rows.next();
}

}  // namespace

StudioStore::StudioStore(const std::filesystem::path& folder)
    : database_(folder / "studio.sqlite", true) {
    database_.run("PRAGMA journal_mode = WAL");
    database_.check();
    SqliteRows rows(database_, "PRAGMA user_version");
    rows.next();
    const std::int64_t version = rows.number(0);
    if (version > schema_version)
        throw InputError(
            (folder / "studio.sqlite").string(),
            fmt::format(
                "was made by a newer item3d (its database has version {}, this one supports {})",
                version, schema_version),
            "use the newer item3d, or another --folder");
    if (version == schema_version) return;
    SqliteTransaction transaction(database_);
    database_.run(schema);
    database_.run(fmt::format("PRAGMA user_version = {}", schema_version));
    transaction.commit();
}

std::int64_t StudioStore::add_project(const std::string& name) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, fmt::format("INSERT INTO projects(name, created, modified) VALUES "
                                           "(?, {}, {}) RETURNING id",
                                           now, now));
    rows.bind(name);
    rows.next();
    const std::int64_t id = rows.number(0);
    rows.next();
    return id;
}

void StudioStore::set_model(std::int64_t project, const std::string& file, const Json& model) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "UPDATE projects SET file = ?, model = ? WHERE id = ?");
    rows.bind(file);
    rows.bind(written(model));
    rows.bind(project);
    rows.next();
}

void StudioStore::rename_project(std::int64_t project, const std::string& name) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "UPDATE projects SET name = ? WHERE id = ?");
    rows.bind(name);
    rows.bind(project);
    rows.next();
}

void StudioStore::mark_project(std::int64_t project, bool favourite) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "UPDATE projects SET favourite = ? WHERE id = ?");
    rows.bind(std::int64_t{favourite});
    rows.bind(project);
    rows.next();
}

std::optional<StudioProject> StudioStore::project(std::int64_t id) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_,
                    fmt::format("SELECT {} FROM projects WHERE id = ?", project_columns));
    rows.bind(id);
    if (!rows.next()) return std::nullopt;
    return read_project(rows);
}

std::vector<StudioProject> StudioStore::projects(std::int64_t limit, std::int64_t before) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, fmt::format("SELECT {} FROM projects WHERE ?1 = 0 OR id < ?1 "
                                           "ORDER BY id DESC LIMIT ?2",
                                           project_columns));
    rows.bind(before);
    rows.bind(limit);
    std::vector<StudioProject> all;
    while (rows.next())
        all.push_back(read_project(rows));
    return all;
}

void StudioStore::remove_project(std::int64_t id) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "DELETE FROM projects WHERE id = ?");
    rows.bind(id);
    rows.next();
}

StudioResult StudioStore::add_result(const StudioResult& result) {
    const std::lock_guard guard(mutex_);
    SqliteTransaction transaction(database_);
    touch(database_, result.project);
    StudioResult added;
    {
        SqliteRows rows(
            database_,
            fmt::format("INSERT INTO results(project, parent, kind, name, request, command, state, "
                        "created) VALUES (?, nullif(?, 0), ?, ?, ?, ?, ?, {}) RETURNING {}",
                        now, result_columns));
        rows.bind(result.project);
        rows.bind(result.parent.value_or(0));
        rows.bind(result.kind);
        rows.bind(result.name);
        rows.bind(written(result.request));
        rows.bind(result.command);
        rows.bind(state_name(result.state));
        rows.next();
        added = read_result(rows);
        rows.next();
    }
    transaction.commit();
    return added;
}

void StudioStore::update_result(const StudioResult& result) {
    const std::lock_guard guard(mutex_);
    SqliteTransaction transaction(database_);
    touch(database_, result.project);
    SqliteRows rows(database_,
                    "UPDATE results SET state = ?, message = ?, seconds = ?, scores = ?, "
                    "files = ?, command = ? WHERE id = ?");
    rows.bind(state_name(result.state));
    rows.bind(result.message);
    rows.bind(result.seconds);
    rows.bind(written(result.scores));
    rows.bind(written(result.files));
    rows.bind(result.command);
    rows.bind(result.id);
    rows.next();
    transaction.commit();
}

void StudioStore::annotate_result(const StudioResult& result) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "UPDATE results SET favourite = ?, note = ?, name = ? WHERE id = ?");
    rows.bind(std::int64_t{result.favourite});
    rows.bind(result.note);
    rows.bind(result.name);
    rows.bind(result.id);
    rows.next();
}

std::optional<StudioResult> StudioStore::result(std::int64_t id) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, fmt::format("SELECT {} FROM results WHERE id = ?", result_columns));
    rows.bind(id);
    if (!rows.next()) return std::nullopt;
    return read_result(rows);
}

std::vector<StudioResult> StudioStore::results(std::optional<std::int64_t> project) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, fmt::format("SELECT {} FROM results WHERE ?1 = 0 OR project = ?1 "
                                           "ORDER BY id",
                                           result_columns));
    rows.bind(project.value_or(0));
    std::vector<StudioResult> all;
    while (rows.next())
        all.push_back(read_result(rows));
    return all;
}

std::vector<StudioResult> StudioStore::results_in(ResultState state) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, fmt::format("SELECT {} FROM results WHERE state = ? ORDER BY id",
                                           result_columns));
    rows.bind(state_name(state));
    std::vector<StudioResult> all;
    while (rows.next())
        all.push_back(read_result(rows));
    return all;
}

void StudioStore::remove_result(std::int64_t id) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(database_, "DELETE FROM results WHERE id = ?");
    rows.bind(id);
    rows.next();
}

}  // namespace item3d
