#include "item3d/batch/plan_jobs.h"

#include "item3d/batch/job_options.h"
#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t id_digits = 16;

/// Options that determine a job's networks and their execution.
const std::vector<std::string> session_options = {
    "controlnet", "controlnet-scale", "device",    "embedding", "instruct",
    "lora",       "method",           "precision", "prior",     "vae"};
const std::vector<std::string> sentence_options = {"from", "to", "instruction", "negative-prompt",
                                                   "lit"};

/// A row whose columns are separated into members.
struct Draft {
    const JobRow* row;
    const JobCommand* command;
    std::string name, model, after;
    json options = json::object();
};

std::string column_text(const json& value, const std::string& column, const std::string& place) {
    if (is_argument(value)) return value.get<std::string>();
    if (value.is_number()) return value.dump();
    throw InputError(place, column + " cannot be " + value.dump(), "expected a string");
}

const JobCommand& command_of(const JobRow& row, const std::vector<JobCommand>& commands) {
    if (!row.values.contains("command")) return commands.front();
    const std::string name = column_text(row.values["command"], "command", row.place);
    std::string list;
    for (const JobCommand& command : commands) {
        if (command.name == name) return command;
        list += (list.empty() ? "" : " or ") + command.name;
    }
    throw InputError(row.place, "unknown command '" + name + "'", "expected " + list);
}

Draft draft_of(const JobRow& row, const std::vector<JobCommand>& commands) {
    Draft draft{&row, &command_of(row, commands), "", "", "", json::object()};
    for (const auto& [given, value] : row.values.items()) {
        const std::string column = column_named(given, *draft.command, row.place);
        if (column == "command") continue;
        if (column == "name")
            draft.name = column_text(value, column, row.place);
        else if (column == "model")
            draft.model = column_text(value, column, row.place);
        else if (column == "after")
            draft.after = column_text(value, column, row.place);
        else
            draft.options[column] = value;
    }
    if (draft.model.empty() == draft.after.empty())
        throw InputError(row.place,
                         draft.model.empty() ? "has no model" : "has both model and after",
                         "give a model, or in `after` the job whose result is read");
    const auto has = [&](const std::string& option) { return draft.options.contains(option); };
    const auto& instead = draft.command->instead;
    if (std::none_of(instead.begin(), instead.end(), has))
        for (const std::string& option : draft.command->required)
            if (!has(option)) throw InputError(row.place, "has no '" + option + "'");
    return draft;
}

/// Returns drafts by name. Throws InputError for a duplicate name.
std::map<std::string, std::size_t> names_of(const std::vector<Draft>& drafts) {
    std::map<std::string, std::size_t> names;
    for (std::size_t i = 0; i < drafts.size(); ++i) {
        if (drafts[i].name.empty()) continue;
        const auto [found, is_new] = names.emplace(drafts[i].name, i);
        if (!is_new)
            throw InputError(drafts[i].row->place,
                             "the name '" + drafts[i].name + "' is used by " +
                                 drafts[found->second].row->place + " too",
                             "give each job a unique name");
    }
    return names;
}

/// Returns a readable name: "mug-tall_2" -> "mug tall 2".
std::string spoken_name(const fs::path& model) {
    std::string name = model.stem().string();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
    return name;
}

std::string with_name(std::string sentence, const std::string& name) {
    constexpr std::string_view mark = "{name}";
    for (std::size_t at = 0; (at = sentence.find(mark, at)) != std::string::npos; at += name.size())
        sentence.replace(at, mark.size(), name);
    return sentence;
}

class Planner {
  public:
    Planner(const std::vector<JobRow>& rows, const JobPlanning& planning) : planning_(planning) {
        for (const JobRow& row : rows)
            drafts_.push_back(draft_of(row, planning.commands));
        names_ = names_of(drafts_);
        ids_.resize(drafts_.size());
        models_.resize(drafts_.size());
    }

    std::vector<BatchJob> plan() {
        for (std::size_t i = 0; i < drafts_.size(); ++i)
            plan_with_those_before(i);
        if (repeated_ > 0)
            note(fmt::format("{} jobs are given more than once and run once", repeated_));
        return std::move(jobs_);
    }

  private:
    void plan_with_those_before(std::size_t last) {
        std::vector<std::size_t> chain;  // the last job, its predecessor, and so on
        for (std::size_t i = last; ids_[i].empty();) {
            if (std::find(chain.begin(), chain.end(), i) != chain.end()) refuse_cycle(chain, i);
            chain.push_back(i);
            const auto before = draft_before(i);
            if (!before) break;
            i = *before;
        }
        for (auto i = chain.rbegin(); i != chain.rend(); ++i)
            plan_one(*i);
    }

    std::optional<std::size_t> draft_before(std::size_t index) const {
        const Draft& draft = drafts_[index];
        if (draft.after.empty()) return std::nullopt;
        if (const auto found = names_.find(draft.after); found != names_.end())
            return found->second;
        if (planning_.known_names.contains(draft.after)) return std::nullopt;
        throw InputError(draft.row->place,
                         "its `after` is '" + draft.after + "', but no job has this name",
                         "give the name of another job (column `name`)");
    }

    [[noreturn]] void refuse_cycle(const std::vector<std::size_t>& chain, std::size_t first) const {
        std::string text;
        for (auto i = std::find(chain.begin(), chain.end(), first); i != chain.end(); ++i)
            text += drafts_[*i].name + " after ";
        throw InputError(drafts_[first].row->place,
                         "the `after` of these jobs form a cycle: " + text + drafts_[first].name,
                         "give one of them a model");
    }

    void plan_one(std::size_t index) {
        const Draft& draft = drafts_[index];
        const std::string& place = draft.row->place;
        BatchJob job;
        job.name = draft.name;
        job.place = place;
        job.command = draft.command->name;
        job.version = planning_.version;
        if (const auto before = draft_before(index)) {
            job.after = ids_[*before];
            models_[index] = models_[*before];
        } else if (!draft.after.empty()) {
            job.after = planning_.known_names.at(draft.after);
            models_[index] = draft.after;
        } else {
            const fs::path model = (draft.row->folder / draft.model).lexically_normal();
            job.model = model.string();
            job.model_hash = hashes_.of_model(model);
            models_[index] = model.filename().string();
        }
        json options = draft.options;
        for (const std::string& option : sentence_options)
            if (options.contains(option))
                options[option] = with_name(column_text(options[option], option, place),
                                            spoken_name(models_[index]));
        const JobOptions given =
            job_options(options, *draft.command, draft.row->folder, place, hashes_);
        job.arguments = given.arguments;
        job.from = options.value("from", "");
        job.to = options.value("to", "");
        check(job);
        identify(job, given.identity, options, index);
        ids_[index] = job.id;
        if (!seen_.insert(job.id).second) ++repeated_;
        jobs_.push_back(std::move(job));
    }

    void check(const BatchJob& job) const {
        try {
            planning_.check(job.command, job.arguments);
        } catch (const Error& error) {
            throw InputError(job.place, error.what());
        }
    }

    void identify(BatchJob& job, const std::string& options, const json& values,
                  std::size_t index) {
        const std::string& model = models_[index];
        const std::string prior = values.contains("prior") && values["prior"].is_string()
                                      ? values["prior"].get<std::string>()
                                      : "";
        const std::string absolute = with_absolute_path("prior", prior, drafts_[index].row->folder);
        const std::string end(1, '\0');
        std::string all = job.version + end + job.command + end + model + end;
        all += job.after.empty() ? job.model_hash : "after " + job.after;
        all += end + prior_identity(absolute) + end + options;
        job.id = sha256(all).substr(0, id_digits);

        std::string asked = job.command + end + job.model + end + job.after;
        for (const std::string& argument : job.arguments)
            asked += end + argument;
        job.key = job.name.empty() ? sha256(asked).substr(0, id_digits) : "name " + job.name;

        std::string session;
        for (const std::string& option : session_options)
            if (values.contains(option)) session += option + end + values[option].dump() + end;
        job.session = session.empty() ? "" : sha256(session).substr(0, id_digits / 2);
        job.folder = job_folder_name(job.id, fs::path(model).stem().string() + " " + job.to);
    }

    const std::string& prior_identity(const std::string& prior) {
        const auto [found, is_new] = priors_.try_emplace(prior);
        if (is_new) found->second = planning_.prior_identity(prior);
        return found->second;
    }

    const JobPlanning& planning_;
    std::vector<Draft> drafts_;
    std::map<std::string, std::size_t> names_;
    std::vector<std::string> ids_;     ///< ids of drafts; "" until planned
    std::vector<std::string> models_;  ///< file names of the drafts' first models
    std::vector<BatchJob> jobs_;
    std::set<std::string> seen_;
    std::size_t repeated_ = 0;
    ContentHashes hashes_;
    std::map<std::string, std::string> priors_;
};

}  // namespace

std::vector<BatchJob> plan_jobs(const std::vector<JobRow>& rows, const JobPlanning& planning) {
    return Planner(rows, planning).plan();
}

}  // namespace item3d
