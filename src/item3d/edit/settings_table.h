// The settings of an edit, one row each: JSON, the checks, the command line's options and
// docs/reference/settings.md come from here.
#pragma once

#include "item3d/edit/setting.h"

#include <string>
#include <vector>

namespace item3d {

/// In the order of `item3d edit --help`.
const std::vector<Setting>& settings_table();

/// Throws std::logic_error where there is none.
const Setting& setting_named(const std::string& name);

}  // namespace item3d
