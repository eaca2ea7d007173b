#include "item3d/compare/page.h"

#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/version.h"
#include "item3d/report/html.h"

#include <algorithm>
#include <limits>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Rows = std::vector<Json>;

constexpr const char* page_style =
    "<style>main { max-width: 1560px; } .wide { overflow-x: auto; } .wide table { min-width: "
    "900px; }"
    " .wide th, .wide td { text-align: right; padding: 7px 12px; overflow-wrap: normal; }"
    " .wide th:first-child { text-align: left; padding-left: 0; color: var(--ink); }"
    " .failed { border-left: 3px solid var(--accent); background: var(--card);"
    " border-radius: 0 10px 10px 0; padding: 12px 16px; }"
    " .failed p { margin: 6px 0 0; overflow-wrap: anywhere; }"
    " .failed b, figure b { font-weight: 600; } figure a { color: inherit; }</style>\n";

std::string text_of(const Json& row, const char* key) {
    return row.at(key).get<std::string>();
}

std::string number(const std::optional<double>& value, int digits, double scale = 1) {
    return value ? fmt::format("{:.{}f}", *value * scale, digits) : "\u2013";
}

std::string table_of(const std::vector<MethodSummary>& summaries, bool names_priors) {
    std::string html =
        "<div class=\"wide\"><table><tr><th>method</th><th>runs</th><th>CLIP, target</th>"
        "<th>CLIP, direction</th><th>\u00b1 seeds</th><th>seconds</th><th>MB</th><th>structure "
        "kept</th><th>geometry kept</th><th>UV kept</th><th>view \u0394E</th><th>baked "
        "light</th></tr>\n";
    for (const MethodSummary& one : summaries) {
        html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td>",
                            html_escape(names_priors ? one.method + ", " + one.prior : one.method),
                            one.ended_well == one.runs
                                ? std::to_string(one.runs)
                                : fmt::format("{} of {}", one.ended_well, one.runs));
        for (const std::string& cell :
             {number(one.clip_global, 3), number(one.clip_directional, 3), number(one.spread, 3),
              number(one.seconds, 0), number(one.peak_memory_bytes, 0, 1e-6),
              number(one.detail_kept, 3), number(one.geometry_kept, 0, 100) + " %",
              number(one.uv_kept, 0, 100) + " %", number(one.view_difference, 2),
              number(one.light_baked, 2)})
            html += "<td>" + (cell.starts_with("\u2013") ? std::string("\u2013") : cell) + "</td>";
        html += "</tr>\n";
    }
    return html +
           "</table></div>\n<p class=\"lede\">Means of the runs that ended. View \u0394E: how far "
           "apart the colours of one surface point are in two views (2.3 is just noticeable; "
           "highlights move). Baked light: correlation of the change of base colour with the "
           "edit's light. \u00b1 seeds: standard deviation of the direction between seeds of a "
           "case.</p>\n";
}

std::string name_of(const Json& row, bool names_priors, bool names_seeds) {
    std::string name = text_of(row, "method");
    if (names_priors) name += ", " + text_of(row, "prior");
    if (names_seeds) name += ", seed " + row.at("seed").dump();
    return name;
}

std::string failure(const Json& row, const std::string& name) {
    return fmt::format("<div class=\"failed\"><b>{}</b><p>{}</p></div>\n", html_escape(name),
                       html_escape(text_of(row, "error")));
}

std::string result_figure(const Json& row, const fs::path& output, const std::string& name) {
    const std::string folder = text_of(row, "folder");
    std::string caption;
    const auto add = [&](const char* key, const char* label, int digits) {
        if (row.contains(key))
            caption += fmt::format(" \u00b7 {} {:.{}f}", label, row[key].get<double>(), digits);
    };
    add("clip_directional", "direction", 2);
    add("detail_kept", "kept", 2);
    add("view_difference", "\u0394E", 1);
    if (row.contains("seconds"))
        caption += fmt::format(" \u00b7 {:.0f} s", row["seconds"].get<double>());
    return fmt::format(
        "<figure><a href=\"{}/report.html\"><img src=\"{}\" alt=\"{}\" loading=\"lazy\"></a>"
        "<figcaption><b>{}</b>{}</figcaption></figure>\n",
        html_escape(folder), data_uri(read_bytes(output / folder / "view.webp")), html_escape(name),
        html_escape(name), caption);
}

/// The rows of one case.
struct CaseRows {
    std::string name;
    Rows rows;
    bool failed() const {
        return std::any_of(rows.begin(), rows.end(),
                           [](const Json& row) { return row.contains("error"); });
    }
    double lowest() const {
        double least = std::numeric_limits<double>::infinity();
        for (const Json& row : rows)
            least = std::min(least, row.value("clip_directional", least));
        return least;
    }
};

std::vector<CaseRows> by_case(const Rows& rows) {
    std::vector<CaseRows> cases;
    for (const Json& row : rows) {
        const std::string name = text_of(row, "case");
        auto found = std::find_if(cases.begin(), cases.end(),
                                  [&](const CaseRows& one) { return one.name == name; });
        if (found == cases.end()) found = cases.insert(cases.end(), {name, {}});
        found->rows.push_back(row);
    }
    std::stable_sort(cases.begin(), cases.end(), [](const CaseRows& a, const CaseRows& b) {
        if (a.failed() != b.failed()) return a.failed();
        return a.lowest() < b.lowest();
    });
    return cases;
}

bool differ(const Rows& rows, const char* key) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const Json& row) { return row.at(key) != rows.front().at(key); });
}

}  // namespace

std::string compare_page(const Rows& rows, const fs::path& output, const std::string& command) {
    const bool priors = !rows.empty() && differ(rows, "prior");
    const bool seeds = !rows.empty() && differ(rows, "seed");
    const std::vector<MethodSummary> summaries = summarize(rows);
    const std::vector<CaseRows> cases = by_case(rows);
    std::string failures;
    std::size_t failed = 0;
    for (const Json& row : rows) {
        if (!row.contains("error")) continue;
        ++failed;
        failures += failure(row, text_of(row, "case") + ", " + name_of(row, priors, seeds));
    }
    std::string body =
        page_style +
        html_header("item3d compare",
                    fmt::format("{} methods, {} cases", summaries.size(), cases.size()),
                    fmt::format("<p class=\"lede\">{} runs, {} failed. <a href=\"table.csv\">"
                                "table.csv</a> has each of them, <a href=\"table.tex\">table.tex"
                                "</a> the table below.</p>\n",
                                rows.size(), failed));
    if (failed > 0)
        body += html_section(
            "Failed", "<div class=\"gallery\" style=\"--least:420px\">\n" + failures + "</div>\n");
    body += html_section("Methods", table_of(summaries, priors));
    for (const CaseRows& one : cases) {
        std::vector<std::string> figures;
        const auto ended = std::find_if(one.rows.begin(), one.rows.end(),
                                        [](const Json& row) { return !row.contains("error"); });
        if (ended != one.rows.end())
            figures.push_back(
                html_figure({"before: " + text_of(*ended, "from"),
                             read_bytes(output / text_of(*ended, "folder") / "before.webp")}));
        for (const Json& row : one.rows) {
            const std::string name = name_of(row, priors, seeds);
            figures.push_back(row.contains("error") ? failure(row, name)
                                                    : result_figure(row, output, name));
        }
        body += html_section(one.name, html_gallery(figures, 330));
    }
    body += "<footer><p><code>" + html_escape(command) + "</code></p><p>item3d " +
            html_escape(version()) + "</p></footer>\n";
    return html_page("Comparison of methods", body);
}

}  // namespace item3d
