// The tables of a comparison: a CSV table with one row per run, and a LaTeX table with one row per
// method.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// Summary of a method's runs with one prior.
struct MethodSummary {
    std::string method;
    std::string prior;
    int runs = 0;
    int ended_well = 0;
    /// Number of pairs of case and seed for which every method with a measured time has one.
    /// `seconds` and `peak_memory_bytes` are means over these pairs. If there are none (0), they
    /// are means over the method's own runs and cannot be compared.
    int timed_together = 0;
    /// Means over the runs that have the value; for booleans, the fraction of these runs in which
    /// it is true. Unset if no run has the value.
    std::optional<double> clip_global, clip_directional, seconds, peak_memory_bytes, detail_kept,
        geometry_kept, uv_kept, view_difference, light_baked, right;
    /// Standard deviation (n - 1) of the directional score over the seeds of a case, averaged over
    /// the cases with two seeds or more.
    std::optional<double> spread;
};

/// Summarizes rows of measured_run(), in the order in which methods and priors first appear.
std::vector<MethodSummary> summarize(const std::vector<nlohmann::json>& rows);

/// A numeric column of the table of methods.
struct TableColumn {
    const char* title;        ///< plain text
    const char* latex_title;  ///< has an arrow in the direction of better values
    std::optional<double> MethodSummary::*value;
    int digits;
    int better;            ///< 1: higher is better, -1: lower is better, 0: neither
    double scale = 1;      ///< factor from the value's unit to the column's
    bool is_cost = false;  ///< true for time and memory
};

/// Returns the columns for which at least one method has a value.
std::vector<TableColumn> table_columns(const std::vector<MethodSummary>& summaries);
/// Returns the number as printed; empty if there is no number.
std::string cell_text(const TableColumn& column, const MethodSummary& summary);
/// True if the method's printed number is better than one other method's and at least as good as
/// all others'. False for time and memory that are not measured over the same cases and seeds.
bool is_best(const TableColumn& column, const MethodSummary& summary,
             const std::vector<MethodSummary>& all);

/// Returns a header and a line for each of `rows`. Missing values are empty; options are written as
/// JSON.
std::string table_csv(const std::vector<nlohmann::json>& rows);

/// Returns a tabular environment (booktabs) with a line for each method. If there are two or more,
/// the best number of each column is bold. Comments above the environment have the numbers of cases
/// and seeds. The lines name the priors if there are several.
std::string table_latex(const std::vector<nlohmann::json>& rows);

}  // namespace item3d
