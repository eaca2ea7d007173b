// Commands of item3d-train.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_prior_command(CLI::App& app);

}  // namespace item3d
