#include "apps/item3d/help_description.h"

#include "apps/item3d/help.h"

namespace item3d {
namespace {

nlohmann::json option_description(const OptionText& option) {
    return {{"names", option.names},
            {"value", option.value},
            {"description", option.description},
            {"group", option.group},
            {"required", option.required},
            {"positional", option.positional},
            {"first_screen", option.first_screen},
            {"repeated", option.repeated}};
}

}  // namespace

nlohmann::json command_description(const CLI::App& command) {
    const CommandHelp& help = help_of(command);
    nlohmann::json options = nlohmann::json::array(), examples = nlohmann::json::array(),
                   commands = nlohmann::json::array();
    for (const OptionText& option : option_texts(command))
        options.push_back(option_description(option));
    for (const HelpExample& example : help.examples)
        examples.push_back({{"purpose", example.purpose}, {"command", example.command}});
    for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
        commands.push_back(command_description(*sub));
    return {{"name", full_name(command)},
            {"description", command.get_description()},
            {"usage", usage_line(command)},
            {"options", options},
            {"notes", command.get_footer()},
            {"examples", examples},
            {"first_screen", help.first_screen},
            {"page", help.page},
            {"commands", commands}};
}

}  // namespace item3d
