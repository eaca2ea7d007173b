// Commands of item3d-bench.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_bench_command(CLI::App& app);

}  // namespace item3d
