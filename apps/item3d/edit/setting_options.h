// The settings of an edit as options of a command. Each given setting is stored under its name in a
// JSON object, which must live as long as the command. The prior determines the other settings.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Adds the option of one setting that has a flag.
CLI::Option* add_setting(CLI::App& command, nlohmann::json& overrides, const std::string& name);

/// Adds the options of all settings of settings_table() that the command lacks.
void add_settings(CLI::App& command, nlohmann::json& overrides);

/// Adds --lora, --embedding, --controlnet, --controlnet-scale and --vae, the extras of a prior
/// (PipelineExtras), for commands that run one.
void add_extras_options(CLI::App& command, nlohmann::json& overrides);

}  // namespace item3d
