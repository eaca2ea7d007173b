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
    checkpoint,  ///< folder of a cancelled call of this tool, which is resumed there
    light,       ///< a preset's name, or a file
    selectors,   ///< selectors of a region, some of which name a file
    texts,
    folders,
    settings,  ///< object with further options of `item3d edit`, by name
};

struct ToolArgument {
    std::string_view name;  ///< name of the option, with _ for -
    ArgumentKind kind;
    std::string_view description;
    bool is_required = false;
    bool is_positional = false;
    std::string_view fallback = {};  ///< value if the argument is not given; empty for none
};

struct Tool {
    std::string_view name, title, description;
    std::string_view command;  ///< command of item3d
    std::vector<ToolArgument> arguments;
    /// Names of files in the result's folder: images that are returned, and files that are linked.
    /// Empty for a command without a result's folder.
    std::vector<std::string_view> images, files;
    bool writes() const { return !images.empty(); }
};

}  // namespace item3d
