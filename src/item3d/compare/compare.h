// The comparison of methods: runs of every case with every method, prior and seed, and the tables
// of results.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Checks the cases (check_cases.h), runs the edits that are not done yet, and writes table.csv,
/// table.tex and index.html into options.output. If options.table_only, runs no edits and leaves
/// unfinished runs out of the tables. command: as typed. Returns {"rows": of measured_run(),
/// "failed": number, "runs": number}. Throws InputError for invalid options; a failed run is a row
/// with "error".
nlohmann::json compare_methods(const CompareOptions& options, const std::string& command);

}  // namespace item3d
