// The relight command, for `item3d relight` and the jobs of a batch.
#pragma once

#include "apps/item3d/command.h"
#include "apps/item3d/edit/light_options.h"
#include "apps/item3d/edit/relight_words.h"
#include "apps/item3d/sign_key_option.h"
#include "item3d/edit/session.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct RelightCommand : CommonOptions {
    std::string model;
    std::vector<std::filesystem::path> texture_folders;
    std::string output;
    std::string light = "studio";
    bool light_is_given = false;
    std::optional<float> sky;  ///< hour of the day; used in place of `light`
    std::string from_light = "studio";
    LightOptions change;
    RelightWords words;
    SignKeyOption sign_key;
    bool punctual = false;
    bool image_based = false;
    bool shadows = true;
    int views = 6;
    int frames = 30;
    int size = 384;
    std::string command;  ///< the command line as typed
};

/// Adds MODEL and all options except the common ones.
void add_relight_options(CLI::App& command, RelightCommand& options);

/// Throws UsageError for contradictory options.
void check_relight_options(const RelightCommand& options);

/// Applies the common options and relights. Returns the content of relight.json. Throws like
/// check_relight_options() and light_by_words().
nlohmann::json perform_relight(const RelightCommand& options, EditSession& session);

}  // namespace item3d
