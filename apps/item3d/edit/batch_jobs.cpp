#include "apps/item3d/edit/batch_jobs.h"

#include "apps/item3d/edit/edit.h"
#include "apps/item3d/edit/relight.h"
#include "item3d/batch/content_hash.h"
#include "item3d/batch/gallery.h"
#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/report/animation.h"
#include "item3d/report/display_image.h"
#include "item3d/report/sheet_image.h"
#include "item3d/tensors/checkpoint.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Options that a batch sets itself.
const std::vector<std::string> own_options = {"help",    "output", "resume",
                                              "threads", "json",   "quiet"};

/// The options of an edit, parsed without the command's callback, which would run the edit.
struct ParsedEdit {
    ParsedEdit() {
        add_common_options(app, options);
        add_edit_options(app, options);
    }
    CLI::App app;
    EditCommandOptions options;
};

struct ParsedRelight {
    ParsedRelight() {
        add_common_options(app, options);
        add_relight_options(app, options);
    }
    CLI::App app;
    RelightCommand options;
};

void parse(CLI::App& app, const std::string& model, const std::string& output,
           const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {model, "-o", output};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::reverse(all.begin(), all.end());  // CLI11 takes a vector in reverse order
    try {
        app.parse(all);
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
}

ColumnKind kind_of(const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return ColumnKind::flag;
    if (option.get_delimiter() != '\0') return ColumnKind::commas;
    const bool takes_several = option.get_items_expected_max() > 1 ||
                               option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
    return takes_several ? ColumnKind::repeated : ColumnKind::single;
}

JobCommand job_command(const std::string& name, const CLI::App& app) {
    JobCommand command{name, {}, {}, {}};
    for (const CLI::Option* option : app.get_options())
        for (const std::string& flag : option->get_lnames())
            if (std::find(own_options.begin(), own_options.end(), flag) == own_options.end())
                command.options[flag] = kind_of(*option);
    return command;
}

/// Returns the command line that repeats the job in its own folder.
std::string command_of(const ClaimedJob& job) {
    std::vector<std::string> words = {"item3d", job.job.command, job.model.string(), "-o",
                                      job.folder.string()};
    words.insert(words.end(), job.job.arguments.begin(), job.job.arguments.end());
    return quoted_command(words);
}

/// Writes thumbnails of the first view for the gallery.
void write_thumbnails(const fs::path& folder, int views) {
    constexpr int side = 128, max_columns = 3;
    constexpr float quality = 80;
    for (const char* name : {before_thumbnail, after_thumbnail}) {
        const fs::path sheet = folder / fs::path(name).replace_extension(".png");
        if (!fs::exists(sheet)) continue;
        const Image image = first_image(load_image(sheet), std::min(views, max_columns));
        if (!image.empty())
            write_atomically(folder / name, encode_webp(thumbnail(image, side), quality));
    }
}

nlohmann::json run_edit_job(const ClaimedJob& job, EditSession& session, bool quiet) {
    ParsedEdit edit;
    parse(edit.app, job.model.string(), job.folder.string(), job.job.arguments);
    edit.options.quiet = quiet;
    edit.options.request.resume = job.resume;
    edit.options.request.command = command_of(job);
    const nlohmann::json summary = perform_edit(edit.options, session);
    nlohmann::json outcome = nlohmann::json::object();
    for (const char* key : {"scores", "seconds", "iterations_done", "peak_memory_bytes"})
        if (summary.contains(key)) outcome[key] = summary[key];
    constexpr int views = 6;
    write_thumbnails(job.folder, views);
    return outcome;
}

nlohmann::json run_relight_job(const ClaimedJob& job, EditSession& session, bool quiet) {
    ParsedRelight relight;
    parse(relight.app, job.model.string(), job.folder.string(), job.job.arguments);
    relight.options.quiet = quiet;
    relight.options.words.resume = job.resume && relight.options.words.given();
    relight.options.command = command_of(job);
    perform_relight(relight.options, session);
    write_thumbnails(job.folder, relight.options.views);
    return nlohmann::json::object();
}

/// Throws InputError if the model's content has changed since the job was planned.
void check_model(const ClaimedJob& job) {
    if (!job.job.after.empty()) {
        if (job.model.empty())
            throw InputError("the job before it", "left no model.glb", "make that job an edit");
        return;
    }
    const std::string hash = ContentHashes().of_model(job.model);
    if (hash.empty()) throw InputError(job.model.string(), "no such file", "check the path");
    if (hash != job.job.model_hash)
        throw InputError(job.model.string(), "has changed since the batch began",
                         "run `item3d batch` with the jobs again");
}

}  // namespace

std::vector<JobCommand> job_commands() {
    JobCommand edit = job_command("edit", ParsedEdit().app);
    edit.required = {"from", "to"};
    edit.instead = {"plan"};
    return {edit, job_command("relight", ParsedRelight().app)};
}

void check_job(const std::string& command, const std::vector<std::string>& arguments) {
    if (command == "relight") {
        ParsedRelight relight;
        parse(relight.app, "model.glb", "folder", arguments);
        check_relight_options(relight.options);
    } else {
        ParsedEdit edit;
        parse(edit.app, "model.glb", "folder", arguments);
        check_edit_options(edit.options);
    }
}

std::string identity_of_prior(const std::string& prior) {
    const fs::path folder = find_prior(prior);
    const fs::path settings = folder / "prior.json";
    return hash_of_weights(folder) +
           (fs::exists(settings) ? sha256(read_text(settings)) : std::string());
}

nlohmann::json JobProcess::run(const ClaimedJob& job) {
    check_model(job);
    if (!session_ || session_name_ != job.job.session) {
        session_.reset();  // releases the old session's networks first
        session_ = std::make_unique<EditSession>();
        session_name_ = job.job.session;
    }
    return job.job.command == "relight" ? run_relight_job(job, *session_, quiet_)
                                        : run_edit_job(job, *session_, quiet_);
}

}  // namespace item3d
