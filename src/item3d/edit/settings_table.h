// The table of an edit's settings, with one row for each. JSON, checks, command-line options and
// docs/reference/settings.md are derived from the table.
#pragma once

#include "item3d/edit/setting.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the rows in the order of `item3d edit --help`.
const std::vector<Setting>& settings_table();

/// Returns the setting of this name. Throws std::logic_error for an unknown name.
const Setting& setting_named(const std::string& name);

}  // namespace item3d
