// Relighting by two sentences. Some words give a direction and some are for the prior; sentences
// without either kind are refused.
#pragma once

#include "item3d/edit/session.h"
#include "item3d/lighting/description.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

struct RelightWords {
    std::string from;
    std::string to;
    std::string prior;  ///< folder or name, as for find_prior(); empty: the embedded prior
    std::string precision = "auto";
    bool resume = false;
    nlohmann::json overrides = nlohmann::json::object();  ///< overrides of the prior's settings

    bool given() const { return !from.empty() || !to.empty(); }
};

/// Adds --from, --to, --prior, --light-model, --guidance, --iterations, --seed, --precision and
/// --resume.
void add_words_options(CLI::App& command, RelightWords& words);

/// Throws UsageError if the sentence names no light that the prior (a folder) knows.
void require_light_words(const std::filesystem::path& prior, const std::string& sentence);

struct WordsLight {
    Image light;
    nlohmann::json record;  ///< "words" of relight.json
};

/// Returns the light that the sentences describe, starting from `from_light` (a preset or a file).
/// Directions are parsed by the grammar of light_words.h. Other words of `to` go to the prior; if
/// they are not about light, no prior is loaded. output: an existing folder. command: the command
/// line as typed. Throws UsageError for sentences that name no light that the prior knows, and the
/// same errors as find_light().
WordsLight light_by_words(const RelightWords& words, const std::filesystem::path& model,
                          const std::string& from_light, const std::filesystem::path& output,
                          at::Device device, const std::string& command, EditSession& session);

}  // namespace item3d
