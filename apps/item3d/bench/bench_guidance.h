#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

/// Adds `guidance` to the commands of `item3d bench`.
void add_bench_guidance(CLI::App& app);

}  // namespace item3d
