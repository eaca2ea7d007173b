// Tables of a comparison: CSV with one row per run, LaTeX with one row per method.
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
    /// Number of cases and seeds for which every method with a time has one. `seconds` and
    /// `peak_memory_bytes` are means over these; 0: there are none, so they are over the method's
    /// own runs and cannot be compared.
    int timed_together = 0;
    /// Means over the runs that have the value, for booleans the fraction that is true; unset if no
    /// run has it.
    std::optional<double> clip_global, clip_directional, seconds, peak_memory_bytes, detail_kept,
        geometry_kept, uv_kept, view_difference, light_baked, right;
    /// Standard deviation (n - 1) of the directional score over the seeds of a case, averaged over
    /// the cases with two seeds or more.
    std::optional<double> spread;
};

/// Summarizes rows of measured_run(), in the order in which methods and priors first appear.
std::vector<MethodSummary> summarize(const std::vector<nlohmann::json>& rows);

/// Numeric column of the table of methods.
struct TableColumn {
    const char* title;        ///< plain text
    const char* latex_title;  ///< with an arrow in the direction of better values
    std::optional<double> MethodSummary::*value;
    int digits;
    int better;            ///< 1: higher, -1: lower, 0: neither
    double scale = 1;      ///< factor from the value's unit to the column's
    bool is_cost = false;  ///< time or memory
};

/// Returns the columns for which any method has a value.
std::vector<TableColumn> table_columns(const std::vector<MethodSummary>& summaries);
/// Returns the printed number, empty if there is none.
std::string cell_text(const TableColumn& column, const MethodSummary& summary);
/// True if the method is better than another one and, as printed, at least as good as all. False
/// for time and memory that are not over the same cases and seeds.
bool is_best(const TableColumn& column, const MethodSummary& summary,
             const std::vector<MethodSummary>& all);

/// Returns a header and a line for each of `rows`; missing values are empty, options are JSON.
std::string table_csv(const std::vector<nlohmann::json>& rows);

/// Returns a tabular environment (booktabs) with a line for each method, the best of each column in
/// bold if there are two or more, below comments with the numbers of cases and seeds. Priors are
/// named if there are several.
std::string table_latex(const std::vector<nlohmann::json>& rows);

}  // namespace item3d
