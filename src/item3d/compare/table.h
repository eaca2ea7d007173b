// The rows of a comparison as files: CSV, one row a run, and LaTeX, one row a method.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace item3d {

/// A method's runs with one prior, together.
struct MethodSummary {
    std::string method;
    std::string prior;
    int runs = 0;
    int ended_well = 0;
    /// Means over the runs that have the value; of a truth value, the share that is true. None
    /// where no run has it.
    std::optional<double> clip_global, clip_directional, seconds, peak_memory_bytes, detail_kept,
        geometry_kept, uv_kept, view_difference, light_baked, right;
    /// Standard deviation (n - 1) of the directional score over the seeds of a case, mean over the
    /// cases with two seeds or more.
    std::optional<double> spread;
};

/// rows: of measured_run(). In the order in which methods and priors first appear.
std::vector<MethodSummary> summarize(const std::vector<nlohmann::json>& rows);

/// A column of numbers of a method.
struct TableColumn {
    const char* title;        ///< plain
    const char* latex_title;  ///< with an arrow where more or less is better
    std::optional<double> MethodSummary::*value;
    int digits;
    int better;        ///< 1: more, -1: less, 0: neither
    double scale = 1;  ///< from the value's unit to the column's
};

/// Those for which any method has a value.
std::vector<TableColumn> table_columns(const std::vector<MethodSummary>& summaries);
/// The number as it is printed, empty where there is none.
std::string cell_text(const TableColumn& column, const MethodSummary& summary);
/// Whether the method is better than one other and, as printed, as good as all.
bool is_best(const TableColumn& column, const MethodSummary& summary,
             const std::vector<MethodSummary>& all);

/// A header and a row for each of `rows`; what a row has not stays empty.
std::string table_csv(const std::vector<nlohmann::json>& rows);

/// A tabular environment (booktabs) with a line for each method, the best of each column in bold
/// where there are two or more. Priors are named where there are several.
std::string table_latex(const std::vector<MethodSummary>& summaries);

}  // namespace item3d
