// What a command says of itself: --help, --help-all, and the same as JSON for man pages, shells and
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

/// Added to what CLI11 knows of a command.
struct CommandHelp {
    /// Long names, without dashes, of the options that `--help` shows; --help-all shows all of
    /// them. Empty: --help does too.
    std::vector<std::string> first_screen = {};
    std::vector<HelpExample> examples = {};
    std::string page = {};  ///< the page to read, as "docs/renderer.md"
    /// What stands behind the name in the line of usage; empty: what is required.
    std::string usage = {};
};

/// One option as people read it.
struct OptionText {
    std::string names;        ///< "-o, --output", or "MODEL"
    std::string value;        ///< "FOLDER", "N", "png|exr"; empty for a flag
    std::string description;  ///< with range and default
    std::string group;
    bool required = false;
    bool positional = false;
    bool first_screen = true;
    bool repeated = false;  ///< may be given several times, or takes several values
};

/// Makes a command show `help`, with --help-all where that leaves options to it.
void use_help(CLI::App& command, CommandHelp help);

const CommandHelp& help_of(const CLI::App& command);
/// "item3d prior train"
std::string full_name(const CLI::App& command);
/// "item3d prior train -o FOLDER [OPTIONS]"
std::string usage_line(const CLI::App& command);
/// In the order in which they are added.
std::vector<OptionText> option_texts(const CLI::App& command);

/// The help, in lines of at most `columns` where words allow it.
std::string help_text(const CLI::App& command, bool all, int columns);

}  // namespace item3d
