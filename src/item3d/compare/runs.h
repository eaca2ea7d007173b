// The edits of a comparison: each a process of its own, in a folder that is named by its content.
#pragma once

#include "item3d/compare/cases.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace item3d {

/// A row of the comparison: a method of the edit, or one with options of its own.
struct CompareMethod {
    std::string name;  ///< in tables and folders
    /// Options of `item3d edit`, which go before a case's; "method" is among them, "item3d" where
    /// it is not.
    nlohmann::json options = nlohmann::json::object();

    std::string edit_method() const { return options.value("method", "item3d"); }
};

/// A method of edit_method_names() as it is.
CompareMethod plain_method(const std::string& name);

/// Pictures of each run beside two views in the edit's light.
struct PictureWishes {
    std::vector<std::string> lights;  ///< presets or files: two views in each
    bool all_views = false;           ///< six views; of controlnet-2d, what it drew
};

struct CompareOptions {
    std::vector<CompareCase> cases;
    std::vector<CompareMethod> methods;
    struct Prior {
        std::string name;              ///< as it was given
        std::filesystem::path folder;  ///< find_prior()
    };
    std::vector<Prior> priors;
    std::vector<std::uint64_t> seeds;
    std::filesystem::path output;
    std::filesystem::path program;  ///< launcher_program()
    int workers = 1;                ///< edits at a time
    int threads = 0;                ///< of each; 0: the machine's, shared between the workers
    PictureWishes pictures;
};

/// A file in the folder of a run that was cut off and went on.
inline constexpr const char* resumed_name = "resumed";

struct CompareRun {
    std::size_t case_index = 0;
    std::string method;       ///< CompareMethod::name
    std::string edit_method;  ///< of edit_method_names()
    std::string prior;        ///< its name
    std::filesystem::path prior_folder;
    std::uint64_t seed = 0;
    std::filesystem::path folder;        ///< output/runs/NAME-METHOD-SEED-HASH
    std::vector<std::string> arguments;  ///< of item3d, but for threads and --resume
};

/// Those of `methods` (of edit_method_names()) that a prior can run by itself: in2n needs an
/// InstructPix2Pix, clip a CLIP.
std::vector<std::string> methods_of_prior(const std::filesystem::path& prior,
                                          const std::vector<std::string>& methods);

/// All runs: prior by prior, seed by seed, case by case, method by method. A folder's name has a
/// hash of all that decides the result: the model file's bytes, the prior's weights and settings,
/// the options, the program's version. Options of one method alone (instruction, clip-loss, ...) go
/// to that method. Throws InputError for two cases that are the same.
std::vector<CompareRun> plan_runs(const CompareOptions& options);

/// Whether the run has ended well.
bool is_done(const CompareRun& run);
/// Whether it was cut off and went on, so that its time and memory are of its last part alone.
bool was_resumed(const CompareRun& run);
/// Why it has not, in one line; empty where it was not tried.
std::string error_of(const CompareRun& run);

}  // namespace item3d
