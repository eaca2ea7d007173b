#include "item3d/compare/page.h"

#include "item3d/compare/pairs.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/version.h"
#include "item3d/report/html.h"

#include <algorithm>
#include <cmath>
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
    " .wide.narrow table { min-width: 0; width: auto; } .wide td b { font-weight: 600; }"
    " .wide th:first-child { text-align: left; padding-left: 0; color: var(--ink); }"
    " .failed { border-left: 3px solid var(--accent); background: var(--card);"
    " border-radius: 0 10px 10px 0; padding: 12px 16px; }"
    " .failed p { margin: 6px 0 0; overflow-wrap: anywhere; }"
    " .failed b, figure b { font-weight: 600; } figure a { color: inherit; }"
    " figure img + img, figure a + a img { margin-top: 6px; }</style>\n";

std::string text_of(const Json& row, const char* key) {
    return row.at(key).get<std::string>();
}

std::string head_of(const MethodSummary& one, bool names_priors) {
    return fmt::format("<tr><th scope=\"row\">{}</th>",
                       html_escape(names_priors ? one.method + ", " + one.prior : one.method));
}

std::string table_of(const std::vector<MethodSummary>& summaries, bool names_priors) {
    const std::vector<TableColumn> columns = table_columns(summaries);
    std::string html = "<div class=\"wide\"><table><tr><th>method</th><th>runs</th>";
    for (const TableColumn& column : columns)
        html += fmt::format("<th>{}</th>", column.title);
    html += "</tr>\n";
    for (const MethodSummary& one : summaries) {
        html += head_of(one, names_priors) +
                fmt::format("<td>{}</td>", one.ended_well == one.runs
                                               ? std::to_string(one.runs)
                                               : fmt::format("{} of {}", one.ended_well, one.runs));
        for (const TableColumn& column : columns) {
            const std::string text = cell_text(column, one);
            html += text.empty()                      ? "<td>\u2013</td>"
                    : is_best(column, one, summaries) ? "<td><b>" + text + "</b></td>"
                                                      : "<td>" + text + "</td>";
        }
        html += "</tr>\n";
    }
    return html +
           "</table></div>\n<p class=\"lede\">Means of the completed runs, the best in bold. View "
           "\u0394E: colour difference of a surface point between two views (2.3 is just "
           "noticeable; highlights also differ). Baked light: correlation of the change of base "
           "colour with the light of the edit. \u00b1 seeds: standard deviation of CLIP direction "
           "between the seeds of a case. Time and memory exclude runs that were interrupted and "
           "resumed.</p>\n";
}

/// Returns the table of paired differences; empty if there is one method.
std::string pairs_of(const Rows& rows, bool names_priors, bool seeds) {
    const std::vector<PairedMethod> methods = beside_first(rows);
    if (methods.empty()) return "";
    const std::string worst = seeds ? "<th>worst seed</th>" : "";
    std::string html =
        "<div class=\"wide narrow\"><table><tr><th>method</th><th>pairs</th><th>CLIP, "
        "direction</th>" +
        worst + "<th>structure kept</th>" + worst + "</tr>\n";
    const auto cells = [&](const PairedDifference& difference) {
        const auto cell = [&](double value) {
            // No minus sign before a number that is printed as zero.
            const double shown = std::abs(value) < 0.0005 ? 0.0 : value;
            return difference.pairs == 0 ? std::string("<td>\u2013</td>")
                                         : fmt::format("<td>{:+.3f}</td>", shown);
        };
        return cell(difference.mean) + (seeds ? cell(difference.worst_seed) : "");
    };
    for (const PairedMethod& one : methods) {
        MethodSummary named;
        named.method = one.method;
        named.prior = one.prior;
        html += head_of(named, names_priors) +
                fmt::format("<td>{}</td>", std::max(one.directional.pairs, one.kept.pairs)) +
                cells(one.directional) + cells(one.kept) + "</tr>\n";
    }
    return html + "</table></div>\n";
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

/// Returns the images of a run's folder in a column, within a link unless `link` is empty.
std::string run_figure(const Json& row, const char* key, const fs::path& output,
                       const std::string& link, const std::string& caption) {
    const std::string folder = text_of(row, "folder");
    std::string html = "<figure>";
    if (!link.empty()) html += "<a href=\"" + html_escape(link) + "\">";
    for (const Json& picture : row.at(key))
        html +=
            fmt::format("<img src=\"{}\" alt=\"{}\" title=\"{}\" loading=\"lazy\">",
                        data_uri(read_bytes(output / folder / text_of(picture, "file"))),
                        html_escape(text_of(row, "method") + ", " + text_of(picture, "caption")),
                        html_escape(text_of(picture, "caption")));
    if (!link.empty()) html += "</a>";
    return html + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string result_figure(const Json& row, const fs::path& output, const std::string& name) {
    std::string caption = "<b>" + html_escape(name) + "</b>";
    const auto add = [&](const char* key, const char* label, int digits) {
        if (row.contains(key))
            caption += fmt::format(" \u00b7 {} {:.{}f}", label, row[key].get<double>(), digits);
    };
    if (row.contains("right") && !row["right"].get<bool>())
        caption += " \u00b7 looks like " + html_escape(text_of(row, "found"));
    add("clip_directional", "direction", 2);
    add("detail_kept", "kept", 2);
    add("view_difference", "\u0394E", 1);
    if (row.contains("seconds"))
        caption += fmt::format(" \u00b7 {:.0f} s", row["seconds"].get<double>());
    return run_figure(row, "pictures", output, text_of(row, "folder") + "/report.html", caption);
}

/// Rows of one case.
struct CaseRows {
    std::string name;
    Rows rows;
    bool failed() const {
        return std::any_of(rows.begin(), rows.end(),
                           [](const Json& row) { return row.contains("error"); });
    }
    double lowest() const {
        double minimum = std::numeric_limits<double>::infinity();
        for (const Json& row : rows)
            minimum = std::min(minimum, row.value("clip_directional", minimum));
        return minimum;
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
        html_header(
            "item3d compare", fmt::format("{} methods, {} cases", summaries.size(), cases.size()),
            fmt::format(
                "<p class=\"lede\">{} runs, {} failed. <a href=\"table.csv\">table.csv</a> lists "
                "each run, <a href=\"table.tex\">table.tex</a> contains the table below.</p>\n",
                rows.size(), failed));
    if (failed > 0)
        body += html_section(
            "Failed", "<div class=\"gallery\" style=\"--least:420px\">\n" + failures + "</div>\n");
    body += html_section("Methods", table_of(summaries, priors));
    if (!rows.empty())
        body += html_section(
            "Compared with " + text_of(rows.front(), "method") + ", on the same cases and seeds",
            pairs_of(rows, priors, seeds));
    for (const CaseRows& one : cases) {
        std::vector<std::string> figures;
        const auto ended = std::find_if(one.rows.begin(), one.rows.end(),
                                        [](const Json& row) { return !row.contains("error"); });
        if (ended != one.rows.end()) {
            std::string caption = "before: " + html_escape(text_of(*ended, "from"));
            const Json& pictures = ended->at("pictures_before");
            for (const Json& picture : pictures)
                if (pictures.size() > 1)
                    caption += " \u00b7 " + html_escape(text_of(picture, "caption"));
            figures.push_back(run_figure(*ended, "pictures_before", output, "", caption));
        }
        for (const Json& row : one.rows) {
            const std::string name = name_of(row, priors, seeds);
            figures.push_back(row.contains("error") ? failure(row, name)
                                                    : result_figure(row, output, name));
        }
        body += html_section(one.name, html_gallery(figures, figures.size() > 4 ? 250 : 330));
    }
    body += "<footer><p><code>" + html_escape(command) + "</code></p><p>item3d " +
            html_escape(version()) + "</p></footer>\n";
    return html_page("Comparison of methods", body);
}

}  // namespace item3d
