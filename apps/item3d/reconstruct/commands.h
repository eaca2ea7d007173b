// Commands of item3d-reconstruct.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_reconstruct_command(CLI::App& app);

}  // namespace item3d
