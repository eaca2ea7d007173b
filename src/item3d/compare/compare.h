// A comparison of methods: every case with every method, prior and seed, and the tables of it.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Runs what is not there yet and writes table.csv, table.tex and index.html into options.output.
/// command: as typed. Returns {"rows": of measured_run(), "failed": how many, "runs": how many}.
/// Throws InputError for options that make no sense; a run that fails is a row with "error".
nlohmann::json compare_methods(const CompareOptions& options, const std::string& command);

}  // namespace item3d
