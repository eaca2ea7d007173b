// Options of the commands that run a prior for what is added to it (models/pipeline_extras.h).
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

/// Adds --lora, --embedding, --controlnet, --controlnet-scale and --vae to a command. What is given
/// goes into `settings` under the members' names of PipelineExtras; `settings` must live as long as
/// the command.
inline void add_extras_options(CLI::App& command, nlohmann::json& settings) {
    const auto set = [&settings](const char* key) {
        return [&settings, key](const auto& value) { settings[key] = value; };
    };
    using Texts = std::vector<std::string>;
    // One value each, or the option would take what stands behind it on the command line.
    command
        .add_option_function<Texts>("--lora", set("lora"),
                                    "FILE or FILE:SCALE: a LoRA (.safetensors) added to the "
                                    "prior's weights; may be given several times")
        ->allow_extra_args(false);
    command
        .add_option_function<Texts>("--embedding", set("embedding"),
                                    "FILE or FILE:TOKEN: a textual inversion (.safetensors), which "
                                    "a prompt then names by its token; may be given several times")
        ->allow_extra_args(false);
    command.add_option_function<std::string>(
        "--controlnet", set("controlnet"),
        "Folder of a depth ControlNet, for a prior that takes no depth itself");
    command.add_option_function<float>("--controlnet-scale", set("controlnet_scale"),
                                       "How much the ControlNet counts, 1 if not given");
    command.add_option_function<std::string>(
        "--vae", set("vae"),
        "Folder of another autoencoder for the prior, as a tiny one for a faster gradient");
}

}  // namespace item3d
