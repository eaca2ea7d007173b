// Tools for agents: commands of item3d with typed arguments.
#pragma once

#include <string_view>
#include <vector>

namespace item3d {

enum class ArgumentKind {
    text,
    number,
    integer,
    file,        ///< inside the allowed folders
    checkpoint,  ///< a result of this tool that was cancelled, and goes on in its folder
    light,       ///< a preset's name, or a file
    selectors,   ///< of a region, some of which name a file
    texts,
    folders,
    settings,  ///< an object of further options of item3d edit by their names
};

struct ToolArgument {
    std::string_view name;  ///< the option's, with _ for -
    ArgumentKind kind;
    std::string_view description;
    bool is_required = false;
    bool is_positional = false;
    std::string_view fallback = {};  ///< passed where it is not given; empty: nothing
};

struct Tool {
    std::string_view name, title, description;
    std::string_view command;  ///< of item3d
    std::vector<ToolArgument> arguments;
    /// Files of the result's folder: shown as pictures, and linked to. Empty for a command that
    /// writes none.
    std::vector<std::string_view> pictures, files;
    bool writes() const { return !pictures.empty(); }
};

}  // namespace item3d
