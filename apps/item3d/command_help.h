// First screens, examples and pages of the commands' help.
#pragma once

#include "apps/item3d/help.h"

#include <string_view>

namespace item3d {

/// name: without "item3d ", as "prior train". Empty for a command that has nothing to add.
CommandHelp command_help(std::string_view name);

}  // namespace item3d
