// The table of an edit's settings, one row each: the source of JSON, checks, command-line options
// and docs/reference/settings.md.
#pragma once

#include "item3d/edit/setting.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns the rows in the order of `item3d edit --help`.
const std::vector<Setting>& settings_table();

/// Throws std::logic_error for an unknown name.
const Setting& setting_named(const std::string& name);

}  // namespace item3d
