#include "item3d/study/comparison_table.h"

#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr std::array wanted_columns = {"case",   "model", "from", "to",
                                       "method", "prior", "seed", "folder"};
constexpr std::array passed_columns = {"clip_global", "clip_directional", "seconds",
                                       "peak_memory_bytes"};

constexpr const char* remake_hint =
    "run the same `item3d compare` command again; it keeps its runs and writes the table anew";

using Header = std::map<std::string, std::size_t>;

Header read_header(const std::vector<std::string>& cells, const std::string& subject) {
    Header header;
    for (std::size_t i = 0; i < cells.size(); ++i)
        header[cells[i]] = i;
    for (const char* column : wanted_columns) {
        if (!header.contains(column))
            throw InputError(subject, fmt::format("has no column '{}'", column),
                             "give the output folder of `item3d compare`");
    }
    return header;
}

ComparisonRow read_row(const std::vector<std::string>& cells, const Header& header,
                       const fs::path& folder) {
    const auto cell = [&](const char* column) { return cells[header.at(column)]; };
    ComparisonRow row{cell("case"), cell("model"),           cell("from"),
                      cell("to"),   cell("method"),          cell("prior"),
                      cell("seed"), folder / cell("folder"), {}};
    for (const char* column : passed_columns) {
        if (!header.contains(column) || cell(column).empty()) continue;
        char* end = nullptr;
        const std::string text = cell(column);
        const double value = std::strtod(text.c_str(), &end);
        if (*end == '\0' && std::isfinite(value)) row.scores[column] = value;
    }
    return row;
}

bool has_images(const fs::path& folder) {
    std::error_code unreadable;  // such as a name that is too long
    for (const char* name : {"before.png", "after.png", "turntable.webp"})
        if (!fs::is_regular_file(folder / name, unreadable)) return false;
    return true;
}

/// Renames methods to "METHOD (PRIOR)" if a comparison has several priors, so that each pair of
/// method and prior is rated separately.
void name_priors(std::vector<ComparisonRow>& rows) {
    const bool several = std::any_of(rows.begin(), rows.end(), [&](const ComparisonRow& row) {
        return row.prior != rows.front().prior;
    });
    if (!several) return;
    for (ComparisonRow& row : rows)
        row.method += " (" + row.prior + ")";
}

}  // namespace

std::vector<ComparisonRow> read_comparison(const fs::path& folder,
                                           std::vector<std::string>& skipped) {
    const fs::path path = folder / "table.csv";
    std::error_code too_long;
    if (!fs::exists(path, too_long) && fs::exists(folder / "runs", too_long))
        throw InputError(folder.string(), "is a comparison that has not ended",
                         "run the same `item3d compare` command again; it continues");
    const auto cells = parse_csv(read_text(path), path.string());
    if (cells.empty()) throw InputError(path.string(), "is empty", remake_hint);
    const Header header = read_header(cells.front(), path.string());
    std::vector<ComparisonRow> rows;
    for (std::size_t line = 1; line < cells.size(); ++line) {
        if (cells[line].size() != cells.front().size())
            throw InputError(path.string(),
                             fmt::format("row {} has {} cells, but the header has {}", line,
                                         cells[line].size(), cells.front().size()),
                             remake_hint);
        ComparisonRow row = read_row(cells[line], header, folder);
        if (has_images(row.folder))
            rows.push_back(std::move(row));
        else
            skipped.push_back(
                fmt::format("{} by {}, seed {}", row.case_name, row.method, row.seed));
    }
    name_priors(rows);
    if (rows.empty())
        throw InputError(path.string(),
                         "no row's folder has before.png, after.png and turntable.webp",
                         "wait until `item3d compare` has ended");
    return rows;
}

}  // namespace item3d
