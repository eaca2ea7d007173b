// The help of a command for --help and --help-all, and as JSON for man pages, shell completions and
// docs.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace item3d {

struct HelpExample {
    std::string purpose;  ///< "one picture, under an evening light"
    std::string command;  ///< "item3d render mug.glb --light sunset -o mug.png"
};

/// Parts of a command's help that CLI11 does not know.
struct CommandHelp {
    /// The long names, without the leading dashes, of the options that --help shows. If empty,
    /// --help shows all options. --help-all always shows all options.
    std::vector<std::string> first_screen = {};
    std::vector<HelpExample> examples = {};
    std::string page = {};  ///< page for further reading, for example "docs/renderer.md"
    /// The usage line after the name. If empty, it has the required options.
    std::string usage = {};
};

/// Display texts of one option.
struct OptionText {
    std::string names;        ///< "-o, --output", or "MODEL"
    std::string value;        ///< "FOLDER", "N", "png|exr"; empty for a flag
    std::string description;  ///< includes the range and the default
    std::string group;
    bool required = false;
    bool positional = false;
    bool first_screen = true;
    bool repeated = false;  ///< may be given several times, or takes several values
};

/// Makes a command show `help`, and adds --help-all if --help hides options.
void use_help(CLI::App& command, CommandHelp help);

const CommandHelp& help_of(const CLI::App& command);
/// Returns the full name of a command: "item3d prior train".
std::string full_name(const CLI::App& command);
/// Returns the usage line: "item3d prior train -o FOLDER [OPTIONS]".
std::string usage_line(const CLI::App& command);
/// Returns the options in the order of their addition.
std::vector<OptionText> option_texts(const CLI::App& command);

/// Returns the help, wrapped at `columns` columns as far as words allow. all: shows all options, as
/// --help-all.
std::string help_text(const CLI::App& command, bool all, int columns);

}  // namespace item3d
