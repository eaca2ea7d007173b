// Relighting by two sentences: which words say a direction, which are the prior's, and what is
// refused.
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
    std::string prior;  ///< folder or name, see find_prior(); empty: the embedded one
    std::string precision = "auto";
    bool resume = false;
    nlohmann::json overrides = nlohmann::json::object();  ///< of the prior's settings

    bool given() const { return !from.empty() || !to.empty(); }
};

/// Adds --from, --to, --prior, --light-model, --guidance, --iterations, --seed, --precision and
/// --resume.
void add_words_options(CLI::App& command, RelightWords& words);

/// Throws UsageError where the sentence names no light that the prior (a folder) knows.
void require_light_words(const std::filesystem::path& prior, const std::string& sentence);

struct WordsLight {
    Image light;
    nlohmann::json record;  ///< what goes into relight.json as "words"
};

/// The light that the sentences ask for, beginning at `from_light` (preset or file). Directions are
/// read by the grammar of light_words.h; what else `to` says goes to the prior, and where that is
/// nothing about light, no prior is loaded. `output` is a folder that is there, command: as typed.
/// Throws UsageError for sentences that name no light that the prior knows, and as find_light().
WordsLight light_by_words(const RelightWords& words, const std::filesystem::path& model,
                          const std::string& from_light, const std::filesystem::path& output,
                          at::Device device, const std::string& command, EditSession& session);

}  // namespace item3d
