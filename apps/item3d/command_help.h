// The help of the commands, which consists of the short text that is shown first, the examples, and
// the full pages.
#pragma once

#include "apps/item3d/help.h"

#include <string_view>

namespace item3d {

/// Returns the help of a command. name: without "item3d ", for example "prior train". Empty for a
/// command without additions.
CommandHelp command_help(std::string_view name);

}  // namespace item3d
