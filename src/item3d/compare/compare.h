// Comparison of methods: every case with every method, prior and seed, and the result tables.
#pragma once

#include "item3d/compare/runs.h"

#include <nlohmann/json.hpp>

#include <string>

namespace item3d {

/// Checks the cases (check_cases.h), runs the edits that are not done yet (table_only: none; rows
/// of unfinished runs are left out) and writes table.csv,
/// table.tex and index.html into options.output. command: as typed. Returns {"rows": of
/// measured_run(), "failed": number, "runs": number}. Throws InputError for invalid options; a
/// failed run is a row with "error".
nlohmann::json compare_methods(const CompareOptions& options, const std::string& command);

}  // namespace item3d
