// Runs of a comparison: each a separate process, in a folder named by a hash of its inputs.
#pragma once

#include "item3d/compare/cases.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// Row of the comparison: a method of the edit, optionally with its own options.
struct CompareMethod {
    std::string name;  ///< in tables and folders
    /// Options of `item3d edit`, overridden by a case's; "method" is among them, default "item3d".
    nlohmann::json options = nlohmann::json::object();

    std::string edit_method() const { return options.value("method", "item3d"); }
};

/// Returns a method of edit_method_names() without options.
CompareMethod plain_method(const std::string& name);

/// Requested images of each run, beside two views in the edit's light.
struct ImageWishes {
    std::vector<std::string> lights;  ///< presets or files: two views in each
    bool all_views = false;           ///< six views; for controlnet-2d its own drawings
};

struct CompareOptions {
    std::vector<CompareCase> cases;
    std::vector<CompareMethod> methods;
    struct Prior {
        std::string name;              ///< as given
        std::filesystem::path folder;  ///< find_prior()
    };
    std::vector<Prior> priors;
    std::vector<std::uint64_t> seeds;
    std::filesystem::path output;
    std::filesystem::path program;  ///< launcher_program()
    int workers = 1;                ///< number of concurrent edits
    int threads = 0;  ///< number for each edit; 0: the machine's, divided among the workers
    ImageWishes images;
    bool table_only = false;  ///< true: no edit starts; the tables have the finished runs
};

/// Marker file in the folder of a run that was interrupted and resumed.
inline constexpr const char* resumed_name = "resumed";

struct CompareRun {
    std::size_t case_index = 0;
    std::string method;       ///< CompareMethod::name
    std::string edit_method;  ///< a name of edit_method_names()
    std::string prior;        ///< name of the prior
    std::filesystem::path prior_folder;
    std::uint64_t seed = 0;
    std::filesystem::path folder;        ///< output/runs/NAME-METHOD-SEED-HASH
    std::vector<std::string> arguments;  ///< item3d's arguments, without threads and --resume
};

/// Returns the options of a case's run with a method: the case's, without those that only another
/// method takes, overridden by the method's; "region" is "all" unless it is given.
nlohmann::json options_of(const CompareCase& test, const CompareMethod& method);

/// Returns those of `methods` (of edit_method_names()) that a prior alone can run: in2n needs an
/// InstructPix2Pix, clip a CLIP.
std::vector<std::string> methods_of_prior(const std::filesystem::path& prior,
                                          const std::vector<std::string>& methods);

/// Returns all runs: by prior, seed, case, then method. A folder's name has a hash of everything
/// that the result depends on: the model file's bytes, the prior's weights and settings, the
/// options, the program's version. Options of one method only (instruction, clip-loss, ...) go to
/// that method. Throws InputError for two equal cases.
std::vector<CompareRun> plan_runs(const CompareOptions& options);

/// True if the run has succeeded.
bool is_done(const CompareRun& run);
/// True if it was interrupted and resumed, so that its time and memory cover only the last part.
bool was_resumed(const CompareRun& run);
/// Returns the run's error in one line; empty if it was not tried.
std::string error_of(const CompareRun& run);

}  // namespace item3d
