#include "item3d/compare/table.h"

#include "item3d/core/csv.h"
#include "item3d/core/format.h"
#include "item3d/core/latex_escape.h"
#include "item3d/core/names.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace item3d {
namespace {

using Json = nlohmann::json;
using Rows = std::vector<Json>;

std::optional<double> number_of(const Json& row, const char* key) {
    const auto found = row.find(key);
    if (found == row.end() || found->is_null()) return std::nullopt;
    return found->is_boolean() ? (found->get<bool>() ? 1.0 : 0.0) : found->get<double>();
}

std::optional<double> mean(const Rows& rows, const char* key) {
    double sum = 0, count = 0;
    for (const Json& row : rows) {
        if (const auto value = number_of(row, key)) {
            sum += *value;
            ++count;
        }
    }
    if (count == 0) return std::nullopt;
    return sum / count;
}

std::optional<double> spread_over_seeds(const Rows& rows, const char* key) {
    std::map<std::string, std::vector<double>> by_case;
    for (const Json& row : rows)
        if (const auto value = number_of(row, key))
            by_case[row.at("case").get<std::string>()].push_back(*value);
    double sum = 0, count = 0;
    for (const auto& [name, values] : by_case) {
        if (values.size() < 2) continue;
        double middle = 0, square = 0;
        for (const double value : values)
            middle += value / static_cast<double>(values.size());
        for (const double value : values)
            square += (value - middle) * (value - middle);
        sum += std::sqrt(square / static_cast<double>(values.size() - 1));
        ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / count;
}

const std::vector<TableColumn> all_columns = {
    {"right, %", "Right (\\%) $\\uparrow$", &MethodSummary::right, 0, 1, 100},
    {"CLIP, target", "CLIP $\\uparrow$", &MethodSummary::clip_global, 3, 1},
    {"CLIP, direction", "CLIP dir.\\ $\\uparrow$", &MethodSummary::clip_directional, 3, 1},
    {"\u00b1 seeds", "$\\pm$ seeds", &MethodSummary::spread, 3, 0},
    {"seconds", "Time (s) $\\downarrow$", &MethodSummary::seconds, 0, -1, 1, true},
    {"MB", "Memory (MB) $\\downarrow$", &MethodSummary::peak_memory_bytes, 0, -1, 1e-6, true},
    {"structure kept", "Structure $\\uparrow$", &MethodSummary::detail_kept, 3, 1},
    {"geometry kept, %", "Geometry kept (\\%)", &MethodSummary::geometry_kept, 0, 0, 100},
    {"UV kept, %", "UV kept (\\%)", &MethodSummary::uv_kept, 0, 0, 100},
    {"view \u0394E", "View $\\Delta E$ $\\downarrow$", &MethodSummary::view_difference, 2, -1},
    {"baked light", "Baked light $r$", &MethodSummary::light_baked, 2, 0},
};

using Key = std::pair<std::string, std::string>;      // method and prior
using Place = std::pair<std::string, std::uint64_t>;  // case and seed

Place place_of(const Json& row) {
    return {row.at("case").get<std::string>(), row.at("seed").get<std::uint64_t>()};
}

/// Returns the pairs of case and seed for which every method with a measured time has one.
std::set<Place> places_timed_together(const std::map<Key, Rows>& groups) {
    std::optional<std::set<Place>> together;
    for (const auto& [key, rows] : groups) {
        std::set<Place> own;
        for (const Json& row : rows)
            if (number_of(row, "seconds")) own.insert(place_of(row));
        if (own.empty()) continue;
        if (!together) together = own;
        std::erase_if(*together, [&](const Place& place) { return !own.contains(place); });
    }
    return together.value_or(std::set<Place>());
}

}  // namespace

std::vector<MethodSummary> summarize(const Rows& rows) {
    std::vector<Key> order;
    std::map<Key, Rows> groups;
    for (const Json& row : rows) {
        const Key key(row.at("method").get<std::string>(), row.at("prior").get<std::string>());
        if (!groups.contains(key)) order.push_back(key);
        groups[key].push_back(row);
    }
    const std::set<Place> together = places_timed_together(groups);
    std::vector<MethodSummary> summaries;
    for (const Key& key : order) {
        const Rows& own = groups[key];
        Rows timed = own;
        if (!together.empty())
            std::erase_if(timed,
                          [&](const Json& row) { return !together.contains(place_of(row)); });
        MethodSummary summary;
        summary.method = key.first;
        summary.prior = key.second;
        summary.runs = static_cast<int>(own.size());
        summary.ended_well = static_cast<int>(std::count_if(
            own.begin(), own.end(), [](const Json& row) { return !row.contains("error"); }));
        summary.timed_together = static_cast<int>(together.size());
        summary.clip_global = mean(own, "clip_global");
        summary.clip_directional = mean(own, "clip_directional");
        summary.seconds = mean(timed, "seconds");
        summary.peak_memory_bytes = mean(timed, "peak_memory_bytes");
        summary.detail_kept = mean(own, "detail_kept");
        summary.geometry_kept = mean(own, "geometry_kept");
        summary.uv_kept = mean(own, "uv_kept");
        summary.view_difference = mean(own, "view_difference");
        summary.light_baked = mean(own, "light_baked");
        summary.right = mean(own, "right");
        summary.spread = spread_over_seeds(own, "clip_directional");
        summaries.push_back(std::move(summary));
    }
    return summaries;
}

std::vector<TableColumn> table_columns(const std::vector<MethodSummary>& summaries) {
    std::vector<TableColumn> used;
    std::copy_if(all_columns.begin(), all_columns.end(), std::back_inserter(used),
                 [&](const TableColumn& column) {
                     return std::any_of(
                         summaries.begin(), summaries.end(),
                         [&](const MethodSummary& one) { return (one.*column.value).has_value(); });
                 });
    return used;
}

std::string cell_text(const TableColumn& column, const MethodSummary& summary) {
    const auto value = summary.*column.value;
    return value ? fmt::format("{:.{}f}", *value * column.scale, column.digits) : "";
}

bool is_best(const TableColumn& column, const MethodSummary& summary,
             const std::vector<MethodSummary>& all) {
    if (column.better == 0 || !(summary.*column.value)) return false;
    if (column.is_cost && summary.timed_together == 0) return false;
    // Numbers are compared as printed: equal digits are equally good.
    const auto shown = [&](const MethodSummary& one) { return std::stod(cell_text(column, one)); };
    bool beats_one = false;
    for (const MethodSummary& other : all) {
        if (!(other.*column.value)) continue;
        const double more = column.better * (shown(summary) - shown(other));
        if (more < 0) return false;
        beats_one |= more > 0;
    }
    return beats_one;
}

std::string table_csv(const Rows& rows) {
    const std::vector<std::string> keys = {"case",
                                           "model",
                                           "from",
                                           "to",
                                           "method",
                                           "prior",
                                           "seed",
                                           "options",
                                           "clip_global",
                                           "clip_before",
                                           "clip_directional",
                                           "seconds",
                                           "peak_memory_bytes",
                                           "unet_rows",
                                           "detail_kept",
                                           "geometry_kept",
                                           "uv_kept",
                                           "view_difference",
                                           "light_baked",
                                           "expect",
                                           "found",
                                           "right",
                                           "error",
                                           "folder"};
    std::string text = csv_line(keys);
    for (const Json& row : rows) {
        std::vector<std::string> fields;
        for (const std::string& key : keys) {
            const Json value = row.value(key, Json());
            fields.push_back(value.is_null() || value == Json::object() ? ""
                             : value.is_string()                        ? value.get<std::string>()
                                                                        : value.dump());
        }
        text += csv_line(fields);
    }
    return text;
}

std::string table_latex(const Rows& rows) {
    const std::vector<MethodSummary> summaries = summarize(rows);
    std::set<std::string> cases;
    std::set<std::uint64_t> seeds;
    for (const Json& row : rows) {
        const auto [name, seed] = place_of(row);
        cases.insert(name);
        seeds.insert(seed);
    }
    const bool names_priors =
        std::any_of(summaries.begin(), summaries.end(),
                    [&](const MethodSummary& one) { return one.prior != summaries.front().prior; });
    const std::vector<TableColumn> columns = table_columns(summaries);
    const int together = summaries.empty() ? 0 : summaries.front().timed_together;
    std::string text =
        fmt::format("% {}; seeds: {}\n% Time and memory: {}\n", counted(cases.size(), "case"),
                    fmt::join(seeds, ", "),
                    together > 0 ? fmt::format("means over the {} that every method has",
                                               counted(static_cast<std::size_t>(together), "run"))
                                 : "each method's own runs, not comparable");
    text +=
        "\\begin{tabular}{l" + std::string(columns.size() + 1, 'r') + "}\n\\toprule\nMethod & Runs";
    for (const TableColumn& column : columns)
        text += fmt::format(" & {}", column.latex_title);
    text += " \\\\\n\\midrule\n";
    for (const MethodSummary& summary : summaries) {
        text += latex_escape(summary.method);
        if (names_priors) text += " (" + latex_escape(summary.prior) + ")";
        text += summary.ended_well == summary.runs
                    ? fmt::format(" & {}", summary.runs)
                    : fmt::format(" & {} of {}", summary.ended_well, summary.runs);
        for (const TableColumn& column : columns) {
            const std::string value = cell_text(column, summary);
            if (value.empty())
                text += " & --";
            else
                text += is_best(column, summary, summaries) ? " & \\textbf{" + value + "}"
                                                            : " & " + value;
        }
        text += " \\\\\n";
    }
    return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace item3d
