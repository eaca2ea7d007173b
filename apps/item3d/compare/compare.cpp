// Command item3d compare: runs a list of edits with every method, and prints the scores in the
// paper's table.
#include "item3d/compare/compare.h"

#include "apps/item3d/command.h"
#include "apps/item3d/compare/commands.h"
#include "item3d/baselines/methods.h"
#include "item3d/compare/suites.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/core/program.h"
#include "item3d/core/seeds.h"
#include "item3d/hub/find_prior.h"
#include "item3d/suite/models.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace item3d {
namespace {

using Meshes = std::map<std::string, std::filesystem::path>;

constexpr int default_rows = 700;

struct CompareCommand : CommonOptions {
    std::filesystem::path cases;  ///< empty: those of the suite
    std::filesystem::path output;
    std::string suite = "methods";
    std::vector<std::string> meshes;
    std::vector<std::string> methods;
    std::vector<std::string> priors;
    std::vector<std::string> lights;
    std::vector<std::string> settings;
    std::string seeds = "0";
    int rows = default_rows;
    bool rows_given = false;
    int workers = 1;
    bool table_only = false;
};

/// True if a case has an option that names the weights that a method needs in addition to the
/// prior.
bool brings(const std::vector<CompareCase>& cases, const char* option) {
    return std::any_of(cases.begin(), cases.end(),
                       [&](const CompareCase& one) { return one.options.contains(option); });
}

/// Returns all methods whose weights are in one of the priors, or are named by a case.
std::vector<CompareMethod> possible_methods(const CompareOptions& options) {
    std::vector<CompareMethod> possible;
    for (const std::string& method : edit_method_names()) {
        const bool by_case = (method == "in2n" && brings(options.cases, "instruct")) ||
                             (method == "clip" &&
                              (brings(options.cases, "clip") || brings(options.cases, "teacher")));
        const bool by_prior = std::any_of(
            options.priors.begin(), options.priors.end(), [&](const CompareOptions::Prior& prior) {
                return !methods_of_prior(prior.folder, {method}).empty();
            });
        if (by_case || by_prior) possible.push_back(plain_method(method));
    }
    return possible;
}

CompareSuite suite_named(const CompareCommand& command) {
    std::string list;
    for (const CompareSuite& suite : compare_suites(command.rows)) {
        if (suite.name == command.suite) return suite;
        list += (list.empty() ? "" : ", ") + suite.name;
    }
    throw InputError("--suite", "unknown suite '" + command.suite + "'", "choose from " + list);
}

/// Returns the methods of these names: the suite's if it has methods of its own, else the general
/// methods.
std::vector<CompareMethod> chosen_methods(const std::vector<std::string>& names,
                                          const CompareSuite& suite) {
    std::vector<CompareMethod> known = suite.methods;
    if (known.empty())
        for (const std::string& name : edit_method_names())
            known.push_back(plain_method(name));
    std::vector<CompareMethod> chosen;
    for (const std::string& name : names) {
        const auto of_name = [&](const CompareMethod& method) { return method.name == name; };
        const auto found = std::find_if(known.begin(), known.end(), of_name);
        if (found == known.end()) {
            std::string list;
            for (const CompareMethod& method : known)
                list += (list.empty() ? "" : ", ") + method.name;
            throw InputError("--methods", "unknown method '" + name + "'", "choose from " + list);
        }
        if (std::any_of(chosen.begin(), chosen.end(), of_name))
            throw UsageError("--methods: '" + name + "' is given twice");
        chosen.push_back(*found);
    }
    return chosen;
}

/// Runs the comparison. If a run failed, throws InputError after the results are written and
/// printed.
void run_compare(const CompareCommand& command) {
    const CompareSuite suite = suite_named(command);
    if (!command.meshes.empty() && !suite.takes_meshes)
        throw UsageError("--mesh requires --suite quality, direction or guidance");
    if (!command.meshes.empty() && !command.cases.empty())
        throw UsageError("--mesh is for the cases of a suite, but " + command.cases.string() +
                         " gives the cases; leave out one of them");
    if (command.rows_given && suite.name != "guidance")
        throw UsageError("--rows requires --suite guidance");
    CompareOptions options;
    options.methods = chosen_methods(command.methods, suite);
    options.seeds = parse_seeds(command.seeds);
    options.output = std::filesystem::absolute(command.output);
    options.workers = command.workers;
    options.threads = command.threads;
    options.program = launcher_program();
    options.table_only = command.table_only;
    std::vector<std::string> names = command.priors;
    if (names.empty()) names.emplace_back("embedded");
    for (const std::string& name : names)
        options.priors.push_back({name, find_prior(name)});
    options.images = suite.images;
    if (!command.lights.empty()) options.images.lights = command.lights;
    if (command.cases.empty()) {
        options.cases =
            cases_of_suite(suite, options.output / "models",
                           command.meshes.empty() ? Meshes() : suite_meshes(command.meshes));
    } else {
        options.cases = read_compare_cases(command.cases);
    }
    set_defaults(options.cases, command.settings);
    if (options.methods.empty())
        options.methods = suite.methods.empty() ? possible_methods(options) : suite.methods;
    const nlohmann::json result = compare_methods(options, command_line());
    if (command.json)
        print_json(result);
    else
        fmt::print("{}\n", (command.output / "index.html").string());
    if (result["failed"] > 0)
        throw InputError(
            command.output.string(),
            fmt::format("{} of {} failed", result["failed"].get<std::size_t>(),
                        counted(result["runs"].get<std::size_t>(), "run")),
            (command.output / "index.html").string() + " says why; the same command tries again");
}

}  // namespace

void add_compare_command(CLI::App& app) {
    auto options = std::make_shared<CompareCommand>();
    CLI::App* command = add_command(app, "compare", *options);
    command->add_option("CASES", options->cases,
                        "Cases as a JSON list or CSV: model, from, to, instruction and other "
                        "options of edit. Default: those of the suite");
    command
        ->add_option(
            "-o,--output", options->output,
            "Folder for the runs, table.csv, table.tex and index.html; existing runs are kept")
        ->type_name("FOLDER")
        ->required();
    command
        ->add_option(
            "--suite", options->suite,
            "Suite: methods, held-out, quality, direction, adjustment, guidance, relighting, "
            "lights, 2d. A suite sets methods, cases and images")
        ->capture_default_str();
    command
        ->add_option("--mesh", options->meshes,
                     "Additional mesh for the cases of quality, direction and guidance")
        ->type_name("NOUN=FILE")
        ->allow_extra_args(false);
    command
        ->add_option("--rows", options->rows,
                     "Forward passes of the U-Net, in rows, for each edit of --suite guidance")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    command
        ->add_option("--lights", options->lights,
                     "Additional lights to render each result in: presets or files")
        ->type_name("LIGHT,...")
        ->delimiter(',');
    command
        ->add_option("--methods", options->methods,
                     "Methods (`item3d edit --method help`). Default: those of the suite, or all "
                     "that the prior can run")
        ->type_name("NAME,...")
        ->delimiter(',');
    command
        ->add_option("--prior", options->priors,
                     "Diffusion model, by folder or name. Default: the embedded prior")
        ->type_name("PRIOR")
        ->allow_extra_args(false);
    command
        ->add_option("--with", options->settings,
                     "Option of edit, such as iterations=100, for all cases that do not give it")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
    command->add_option("--seeds", options->seeds, "Seeds: 0..2, or numbers with commas")
        ->type_name("SEEDS")
        ->capture_default_str();
    command
        ->add_option("--workers", options->workers,
                     "Edits that run at the same time, as far as memory allows; they share the "
                     "cores, which makes the measured times longer")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_flag("--table-only", options->table_only,
                      "Start no edit: write the tables and the page of the runs that have "
                      "finished");
    command->callback([options, command] {
        options->rows_given = command->count("--rows") > 0;
        start_command(*options);
        run_compare(*options);
    });
}

}  // namespace item3d
