// Settings of an edit as options of a command. What is given goes into a JSON object under the
// settings' names, which must live as long as the command; what is absent is left to the prior.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Adds the option of one setting, which has a flag.
CLI::Option* add_setting(CLI::App& command, nlohmann::json& overrides, const std::string& name);

/// Adds the options of all settings of settings_table() that the command does not have already.
void add_settings(CLI::App& command, nlohmann::json& overrides);

/// Adds --lora, --embedding, --controlnet, --controlnet-scale and --vae, for the commands that run
/// a prior: what is added to it (PipelineExtras).
void add_extras_options(CLI::App& command, nlohmann::json& overrides);

}  // namespace item3d
