// Commands of item3d-study.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_study_command(CLI::App& app);

}  // namespace item3d
