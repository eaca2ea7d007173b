#include "item3d/studio/studio.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/named_files.h"
#include "item3d/core/parse_json.h"
#include "item3d/io/find_file.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"
#include "item3d/studio/archive.h"
#include "item3d/studio/edit_history.h"
#include "item3d/studio/halved.h"

#include <algorithm>
#include <array>
#include <limits>
#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::array folders_of_files = {"textures", "views", "live"};
constexpr int thumbnail_edge = 128;  ///< pixels
/// Files that only an edit itself uses.
constexpr std::array private_files = {"checkpoint.safetensors", "plan_state.json"};

Json read_catalogue(const fs::path& page) {
    const fs::path file = page / "settings.json";
    Json settings = parse_json(read_text(file));
    if (!settings.is_array())
        throw InputError(file.string(), "is not a list of settings", "install item3d again");
    return settings;
}

Json read_object(const fs::path& file) {
    Json json = parse_json(read_text(file));
    return json.is_object() ? json : Json::object();
}

bool has_same_bytes(const fs::path& a, const fs::path& b) {
    std::error_code code;
    if (fs::file_size(a, code) != fs::file_size(b, code) || code) return false;
    return read_bytes(a) == read_bytes(b);
}

/// Returns the existing files in the folder of a model that the model names, relative to the
/// folder.
std::vector<fs::path> files_beside(const fs::path& model) {
    const fs::path folder = fs::canonical(model.has_parent_path() ? model.parent_path() : ".");
    std::vector<fs::path> found;
    for (const std::string& name : files_named_by(model)) {
        std::vector<std::string> spellings = other_spellings(name);
        spellings.insert(spellings.begin(), name);
        for (const std::string& spelling : spellings)
            if (const auto file = find_file_below(folder, spelling)) {
                found.push_back(file->lexically_relative(folder));
                break;
            }
    }
    return found;
}

void check_kind(const std::string& name) {
    if (!is_model_file(name) && to_lower(fs::path(name).extension().string()) != ".zip")
        throw InputError(shown_name(name, "the file"), "has an unsupported format",
                         "choose a " + model_extensions_text() + ", or a .zip of a model's folder");
}

}  // namespace

std::filesystem::path demo_model() {
    return assets_folder() / "demo" / "mug.glb";
}

Studio::Studio(StudioOptions options)
    : options_(std::move(options)),
      folders_(options_.folder, options_.programs),
      lock_(options_.folder, "`item3d studio`"),
      store_(options_.folder),
      access_(options_.access),
      commands_(folders_, read_catalogue(options_.page)),
      jobs_(
          store_, events_, folders_, commands_,
          [this](StudioResult& result) { take_result(result); },
          [this](const StudioResult& result) { return clock_of(result); }) {
    folders_.clear_incoming();
    remove_unread_projects();
}

/// Removes projects whose model was not completely stored when the server was killed. Their upload
/// was never confirmed. Projects of photographs have no model before they are reconstructed, and a
/// project with results is always kept.
void Studio::remove_unread_projects() {
    for (const StudioProject& project : store_.projects(std::numeric_limits<int>::max(), 0)) {
        const fs::path folder = folders_.project(project.id);
        if (!project.file.empty() || fs::exists(folder / "photographs") ||
            !store_.results(project.id).empty())
            continue;
        store_.remove_project(project.id);
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
}

/// Reads a model in a separate process, because a broken file may crash that process.
void Studio::read_model(std::int64_t project, const fs::path& model) {
    const fs::path folder = folders_.project(project);
    const StudioCommand command{"studio", {"read-model", model.string(), folder.string()}};
    constexpr auto longest = std::chrono::seconds(120);
    run_now(command, folder, folder / "read.log", longest);
    const fs::path source = folder / "source";
    Json facts = read_object(folder / "model.json");
    for (Json& warning : facts["warnings"])
        if (warning.is_string()) warning = folders_.without_paths(warning.get<std::string>());
    sync_tree(source);  // a project with a model in the database keeps it after a power failure
    store_.set_model(project, fs::relative(model, source).string(), facts);
}

StudioProject Studio::add_project(const std::string& name,
                                  const std::function<fs::path(const fs::path& source)>& place) {
    const std::int64_t id = store_.add_project(shown_name(name, "model"));
    const fs::path folder = folders_.project(id);
    try {
        make_output_folder(folder);
        read_model(id, place(folder / "source"));
    } catch (...) {
        std::error_code ignored;
        store_.remove_project(id);
        fs::remove_all(folder, ignored);
        throw;
    }
    const StudioProject opened = project(id);
    events_.send("project", project_json(opened));
    return opened;
}

StudioProject Studio::open_model(const fs::path& file, const std::string& name) {
    check_kind(name);
    return add_project(name, [&](const fs::path& source) {
        fs::create_directories(source);
        if (to_lower(fs::path(name).extension().string()) == ".zip") {
            const fs::path archive = source.parent_path() / stored_name(name);
            fs::copy_file(file, archive);
            const fs::path model = unpack_model(archive, source);
            fs::remove(archive);
            return model;
        }
        fs::copy_file(file, source / stored_name(name));
        return source / stored_name(name);
    });
}

StudioProject Studio::open_folder(const fs::path& folder, const fs::path& model) {
    return add_project(model.filename().string(), [&](const fs::path& source) {
        fs::rename(folder, source);
        return source / model;
    });
}

StudioProject Studio::open_again(const fs::path& file) {
    if (!fs::is_regular_file(file))
        throw InputError(file.string(), "no such file", "check the path");
    const std::vector<fs::path> named = files_beside(file);
    constexpr std::int64_t looked_at = 200;
    for (const StudioProject& known : store_.projects(looked_at, 0)) {
        const fs::path source = folders_.project(known.id) / "source";
        if (!known.file.empty() && has_same_bytes(source / known.file, file) &&
            std::all_of(named.begin(), named.end(), [&](const fs::path& name) {
                return has_same_bytes(source / name, file.parent_path() / name);
            }))
            return known;
    }
    const std::string name = file.filename().string();
    if (named.empty()) return open_model(file, name);
    check_kind(name);
    return add_project(name, [&](const fs::path& source) {
        for (const fs::path& each : named) {
            fs::create_directories((source / each).parent_path());
            fs::copy_file(file.parent_path() / each, source / each,
                          fs::copy_options::skip_existing);
        }
        fs::create_directories(source);
        fs::copy_file(file, source / stored_name(name));
        return source / stored_name(name);
    });
}

StudioResult Studio::reconstruct(const fs::path& photographs, const std::string& name) {
    const std::int64_t id = store_.add_project(shown_name(name, "Photographs"));
    make_output_folder(folders_.project(id));
    fs::rename(photographs, folders_.project(id) / "photographs");
    sync_tree(folders_.project(id) / "photographs");
    events_.send("project", project_json(project(id)));
    StudioResult result;
    result.project = id;
    result.kind = "reconstruct";
    return jobs_.add(result);
}

/// Returns the clock of an edit; other results have no time plan.
JobClock Studio::clock_of(const StudioResult& result) {
    if (result.kind != "edit") return {};
    try {
        const EditHistory history = read_edit_history(store_, folders_);
        return JobClock(
            expected_seconds(result.request, history.defaults, history.costs, history.threads));
    } catch (const InputError&) {
        return {};  // there is no shipped prior
    }
}

void Studio::take_result(StudioResult& result) {
    const fs::path folder = folders_.result(result.project, result.id);
    if (fs::exists(folder / "edit.json")) {
        const Json summary = read_object(folder / "edit.json");
        result.scores = summary.value("scores", Json::object());
    }
    if (result.kind == "reconstruct") {
        const fs::path source = folders_.project(result.project) / "source";
        fs::create_directories(source);
        fs::copy_file(folder / "model.glb", source / "model.glb",
                      fs::copy_options::overwrite_existing);
        read_model(result.project, source / "model.glb");
        events_.send("project", project_json(project(result.project)));
    }
    if (fs::exists(folder / "preview.png"))
        save_image(folder / thumbnail_name,
                   first_view(load_image(folder / "preview.png"), thumbnail_edge));
    result.files = files_of(result);
}

void Studio::remove_project(std::int64_t id) {
    for (const StudioResult& result : store_.results(project(id).id))
        if (result.state == ResultState::running)
            throw InputError("project", "one of its results is still running", "cancel it first");
    store_.remove_project(id);
    std::error_code ignored;
    fs::remove_all(folders_.project(id), ignored);
    events_.send("project", {{"id", id}, {"removed", true}});
}

StudioProject Studio::project(std::int64_t id) {
    const auto found = store_.project(id);
    if (!found) throw InputError("project", "does not exist", "it may have been removed");
    return *found;
}

StudioResult Studio::result(std::int64_t id) {
    const auto found = store_.result(id);
    if (!found) throw InputError("result", "does not exist", "it may have been removed");
    return *found;
}

std::vector<std::string> Studio::files_of(const StudioResult& result) const {
    const fs::path folder = folders_.result(result.project, result.id);
    std::vector<std::string> names;
    const auto add = [&](const fs::path& inside, const std::string& before) {
        std::error_code code;
        for (const auto& entry : fs::directory_iterator(inside, code)) {
            const std::string name = entry.path().filename().string();
            if (!entry.is_regular_file() || name.find(".tmp") != std::string::npos) continue;
            if (std::find(private_files.begin(), private_files.end(), name) == private_files.end())
                names.push_back(before + name);
        }
    };
    add(folder, "");
    for (const char* inner : folders_of_files)
        add(folder / inner, std::string(inner) + "/");
    std::sort(names.begin(), names.end());
    return names;
}

void Studio::run_now(const StudioCommand& command, const fs::path& folder, const fs::path& log,
                     std::chrono::seconds longest) {
    // Models are read in parallel with longer commands.
    const std::lock_guard guard(command.family == "studio" ? reading_ : running_now_);
    std::error_code ignored;
    fs::remove(log, ignored);
    std::vector<std::string> arguments = {folders_.program(command.family).string()};
    arguments.insert(arguments.end(), command.arguments.begin(), command.arguments.end());
    ChildProgram program(arguments, log, {folder, "item3d"});
    const auto last = std::chrono::steady_clock::now() + longest;
    std::optional<int> status;
    while (!(status = program.status())) {
        if (std::chrono::steady_clock::now() > last)
            throw InputError(command.arguments.front(), "took too long and was stopped");
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    // The program's own error line names the problem and a remedy.
    if (*status != 0)
        throw Error(ExitCode::bad_input, folders_.without_paths(reason_of_end(log, *status)));
}

}  // namespace item3d
