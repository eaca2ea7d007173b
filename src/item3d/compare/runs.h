// The runs of a comparison. Each is a process of its own, in a folder whose name has a hash of the
// run's inputs.
#pragma once

#include "item3d/compare/cases.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// A row of the comparison: a method of `item3d edit`, optionally with options of its own.
struct CompareMethod {
    std::string name;  ///< name in tables and folders
    /// Options of `item3d edit`, which override a case's options (options_of()). They include
    /// "method", by default "item3d".
    nlohmann::json options = nlohmann::json::object();

    std::string edit_method() const { return options.value("method", "item3d"); }
};

/// Returns a method of edit_method_names() without options.
CompareMethod plain_method(const std::string& name);

/// Requested images of each run, beside two views in the edit's light.
struct ImageWishes {
    std::vector<std::string> lights;  ///< presets or files; each gives two views
    bool all_views = false;  ///< true: six views; for controlnet-2d, the images that it drew
};

struct CompareOptions {
    std::vector<CompareCase> cases;
    std::vector<CompareMethod> methods;
    struct Prior {
        std::string name;              ///< name as the user gave it
        std::filesystem::path folder;  ///< find_prior()
    };
    std::vector<Prior> priors;
    std::vector<std::uint64_t> seeds;
    std::filesystem::path output;
    std::filesystem::path program;  ///< launcher_program()
    int workers = 1;                ///< number of concurrent edits
    int threads = 0;  ///< threads of each edit; 0: the machine's, divided among the workers
    ImageWishes images;
    bool table_only = false;  ///< true: no edit starts; the tables show the finished runs
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

/// Returns the options of a case's run with a method. They are the case's options, without those
/// that only another method takes; the method's options override them. "region" is "all" unless it
/// is given.
nlohmann::json options_of(const CompareCase& test, const CompareMethod& method);

/// Returns those of `methods` (a subset of edit_method_names()) that can run with the networks of
/// the prior's folder: in2n needs an InstructPix2Pix, clip needs a CLIP.
std::vector<std::string> methods_of_prior(const std::filesystem::path& prior,
                                          const std::vector<std::string>& methods);

/// Returns all runs, ordered by prior, seed, case and method. A folder's name has a hash of
/// everything that the result depends on: the model file's bytes, the prior's weights and settings,
/// the options, the program's version. Options that only one method takes (instruction, clip-loss,
/// ...) are passed only to that method. Throws InputError for two equal cases.
std::vector<CompareRun> plan_runs(const CompareOptions& options);

/// True if the run has succeeded.
bool is_done(const CompareRun& run);
/// True if the run was interrupted and resumed. Its time and memory then cover only the last part.
bool was_resumed(const CompareRun& run);
/// Returns the run's error in one line; empty if the run was not tried.
std::string error_of(const CompareRun& run);

}  // namespace item3d
