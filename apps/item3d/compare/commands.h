// Commands of item3d-compare.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_compare_command(CLI::App& app);

}  // namespace item3d
