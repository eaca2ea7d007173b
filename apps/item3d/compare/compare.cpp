// item3d compare: a list of edits with every method, and the paper's table of them.
#include "item3d/compare/compare.h"

#include "apps/item3d/command.h"
#include "apps/item3d/compare/commands.h"
#include "item3d/baselines/methods.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/hub/find_prior.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

struct CompareCommand : CommonOptions {
    std::filesystem::path cases;  ///< empty: those that come along
    std::filesystem::path output;
    std::vector<std::string> methods;
    std::vector<std::string> priors;
    std::string seeds = "0";
    int workers = 1;
};

/// Whether a case brings the weights that a method needs beside the prior.
bool brings(const std::vector<CompareCase>& cases, const char* option) {
    return std::any_of(cases.begin(), cases.end(),
                       [&](const CompareCase& one) { return one.options.contains(option); });
}

/// All that any of the priors, or a case, has the weights for.
std::vector<std::string> possible_methods(const CompareOptions& options) {
    std::vector<std::string> possible;
    for (const std::string& method : edit_method_names()) {
        const bool by_case = (method == "in2n" && brings(options.cases, "instruct")) ||
                             (method == "clip" &&
                              (brings(options.cases, "clip") || brings(options.cases, "teacher")));
        const bool by_prior = std::any_of(
            options.priors.begin(), options.priors.end(), [&](const CompareOptions::Prior& prior) {
                return !methods_of_prior(prior.folder, {method}).empty();
            });
        if (by_case || by_prior) possible.push_back(method);
    }
    return possible;
}

void check_methods(const std::vector<std::string>& methods) {
    const auto& known = edit_method_names();
    for (std::size_t i = 0; i < methods.size(); ++i) {
        if (std::find(known.begin(), known.end(), methods[i]) == known.end())
            throw UsageError(fmt::format("--methods: there is no method '{}': there are {}",
                                         methods[i], fmt::join(known, ", ")));
        if (std::count(methods.begin(), methods.end(), methods[i]) > 1)
            throw UsageError("--methods: '" + methods[i] + "' is there twice");
    }
}

void run_compare(const CompareCommand& command) {
    check_methods(command.methods);
    CompareOptions options;
    options.seeds = parse_seeds(command.seeds);
    options.output = std::filesystem::absolute(command.output);
    options.workers = command.workers;
    options.threads = command.threads;
    options.program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "item3d-edit";
    std::vector<std::string> names = command.priors;
    if (names.empty()) names.emplace_back("embedded");
    for (const std::string& name : names)
        options.priors.push_back({name, find_prior(name)});
    if (!std::filesystem::exists(options.program))
        throw ResourceError(options.program.string() +
                            ": is not there; build it (make) or install item3d again");
    options.cases = command.cases.empty()
                        ? default_compare_cases(options.output / "models", options.priors[0].folder)
                        : read_compare_cases(command.cases);
    options.methods = command.methods.empty() ? possible_methods(options) : command.methods;
    const nlohmann::json result = compare_methods(options, command_line());
    if (command.json)
        print_json(result);
    else
        fmt::print("{}\n", (command.output / "index.html").string());
}

}  // namespace

void add_compare_command(CLI::App& app) {
    auto options = std::make_shared<CompareCommand>();
    CLI::App* command = add_command(app, "compare", *options);
    command->add_option(
        "CASES", options->cases,
        "JSON list or CSV file of cases: model, from, to, instruction and other "
        "options of edit; without it, the demo's mug and two shapes of item3d's own");
    command
        ->add_option("-o,--output", options->output,
                     "Folder for the runs, table.csv, table.tex and index.html; what is there "
                     "already is kept")
        ->required();
    command
        ->add_option("--methods", options->methods,
                     "Of item3d edit --method help, with commas; without it, all that the prior "
                     "can run")
        ->delimiter(',');
    command
        ->add_option("--prior", options->priors,
                     "A folder or a name; may be given several times; without it, the embedded "
                     "one")
        ->allow_extra_args(false);
    command->add_option("--seeds", options->seeds, "0..2, or numbers with commas")
        ->capture_default_str();
    command
        ->add_option("--workers", options->workers,
                     "Edits at a time, as far as memory allows; they share the cores, so that "
                     "seconds are those of a busy machine")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->callback([options] {
        start_command(*options);
        run_compare(*options);
    });
}

}  // namespace item3d
