// Help of a command: --help, --help-all, and JSON for man pages, shell completions and docs.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace item3d {

struct HelpExample {
    std::string purpose;  ///< "one picture, under an evening light"
    std::string command;  ///< "item3d render mug.glb --light sunset -o mug.png"
};

/// Additions to CLI11's knowledge of a command.
struct CommandHelp {
    /// Long names, without dashes, of the options that `--help` shows; --help-all shows all
    /// options. If empty, --help shows all options too.
    std::vector<std::string> first_screen = {};
    std::vector<HelpExample> examples = {};
    std::string page = {};  ///< page to read, for example "docs/renderer.md"
    /// Usage line after the name; empty: the required options.
    std::string usage = {};
};

/// Display texts of one option.
struct OptionText {
    std::string names;        ///< "-o, --output", or "MODEL"
    std::string value;        ///< "FOLDER", "N", "png|exr"; empty for a flag
    std::string description;  ///< range and default included
    std::string group;
    bool required = false;
    bool positional = false;
    bool first_screen = true;
    bool repeated = false;  ///< may be given several times, or takes several values
};

/// Makes a command show `help`, and adds --help-all if --help hides options.
void use_help(CLI::App& command, CommandHelp help);

const CommandHelp& help_of(const CLI::App& command);
/// Returns the full name: "item3d prior train".
std::string full_name(const CLI::App& command);
/// Returns the usage line: "item3d prior train -o FOLDER [OPTIONS]".
std::string usage_line(const CLI::App& command);
/// Returns the options in the order of their addition.
std::vector<OptionText> option_texts(const CLI::App& command);

/// Returns the help, wrapped at `columns` as far as words allow.
std::string help_text(const CLI::App& command, bool all, int columns);

}  // namespace item3d
