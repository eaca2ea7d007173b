#include "item3d/compare/page.h"

#include "item3d/compare/pairs.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
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
    // A shadow marks each side to which the table can be scrolled.
    " .wide { background: linear-gradient(to right, var(--paper) 40%, transparent) left,"
    " linear-gradient(to left, var(--paper) 40%, transparent) right,"
    " linear-gradient(to right, rgba(0,0,0,.2), transparent) left,"
    " linear-gradient(to left, rgba(0,0,0,.2), transparent) right;"
    " background-size: 42px 100%, 42px 100%, 14px 100%, 14px 100%; background-repeat: no-repeat;"
    " background-attachment: local, local, scroll, scroll; }"
    " .wide th, .wide td { text-align: right; padding: 7px 12px; overflow-wrap: normal; }"
    " .wide.narrow table { min-width: 0; width: auto; } .wide td b { font-weight: 600; }"
    " .wide th:first-child { text-align: left; padding-left: 0; color: var(--ink); }"
    " .failed { border-left: 3px solid var(--accent); background: var(--card);"
    " border-radius: 0 10px 10px 0; padding: 12px 16px; }"
    " .failed p { margin: 6px 0 0; overflow-wrap: anywhere; } .wrong { color: var(--accent); }"
    " .even { display: grid; gap: 32px 20px;"
    " grid-template-columns: repeat(var(--columns), minmax(0, 1fr)); }"
    " @media (max-width: 900px) { .even { grid-template-columns: repeat(2, minmax(0, 1fr)); } }"
    " .even .failed { align-self: start; } .sought { margin: 0 0 18px; }"
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
    const int together = summaries.empty() ? 0 : summaries.front().timed_together;
    const std::string times =
        together > 0
            ? fmt::format(
                  "Time and memory: over the {} that every method has without an "
                  "interruption.",
                  counted(static_cast<std::size_t>(together), "run"))
            : std::string("Time and memory: each method's own runs, which cannot be compared.");
    return html +
           "</table></div>\n<p class=\"lede\">Means of the completed runs, the best in bold. " +
           times +
           " View "
           "\u0394E: colour difference of a surface point between two views (2.3 is just "
           "noticeable; highlights also differ). Baked light: correlation of the change of base "
           "colour with the light of the edit. \u00b1 seeds: standard deviation of CLIP direction "
           "between the seeds of a case.</p>\n";
}

/// Returns the table of paired differences; empty if there is only one method.
std::string pairs_of(const Rows& rows, bool names_priors, bool seeds) {
    const std::vector<PairedMethod> methods = beside_first(rows);
    if (methods.empty()) return "";
    struct Column {
        const char* title;
        PairedDifference PairedMethod::*difference;
        int digits;
        double scale = 1;
    };
    std::vector<Column> columns = {{"right, %", &PairedMethod::right, 0, 100},
                                   {"CLIP, direction", &PairedMethod::directional, 3},
                                   {"structure kept", &PairedMethod::kept, 3},
                                   {"view \u0394E", &PairedMethod::view_difference, 2},
                                   {"seconds", &PairedMethod::seconds, 0}};
    std::erase_if(columns, [&](const Column& column) {
        return std::all_of(methods.begin(), methods.end(), [&](const PairedMethod& one) {
            return (one.*column.difference).pairs == 0;
        });
    });
    // The worst seed is shown only for values of which more is better.
    const auto has_worst = [&](const Column& column) {
        return seeds && (column.difference == &PairedMethod::directional ||
                         column.difference == &PairedMethod::kept);
    };
    std::string html = "<div class=\"wide narrow\"><table><tr><th>method</th><th>pairs</th>";
    for (const Column& column : columns)
        html += fmt::format("<th>{}</th>{}", column.title,
                            has_worst(column) ? "<th>worst seed</th>" : "");
    html += "</tr>\n";
    for (const PairedMethod& one : methods) {
        MethodSummary named;
        named.method = one.method;
        named.prior = one.prior;
        int pairs = 0;
        std::string cells;
        for (const Column& column : columns) {
            const PairedDifference& difference = one.*column.difference;
            pairs = std::max(pairs, difference.pairs);
            const auto cell = [&](double value) {
                // No minus sign before a number that is printed as zero.
                const double least = 0.5 * std::pow(10.0, -column.digits);
                const double scaled = value * column.scale;
                return difference.pairs == 0
                           ? std::string("<td>\u2013</td>")
                           : fmt::format("<td>{:+.{}f}</td>",
                                         std::abs(scaled) < least ? 0.0 : scaled, column.digits);
            };
            cells += cell(difference.mean);
            if (has_worst(column)) cells += cell(difference.worst_seed);
        }
        html +=
            head_of(named, names_priors) + fmt::format("<td>{}</td>", pairs) + cells + "</tr>\n";
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
    return fmt::format(
        "<div class=\"failed\"><b>{}</b><p>{}</p><p><a href=\"{}\">log.txt</a></p></div>\n",
        html_escape(name), html_escape(text_of(row, "error")),
        html_escape(text_of(row, "folder") + "/log.txt"));
}

/// Returns the note that takes the place of a failed run's images.
std::string failure_note(const std::string& name) {
    return fmt::format(
        "<div class=\"failed\"><b>{}</b><p>failed: <a href=\"#failed\">why</a></p></div>\n",
        html_escape(name));
}

/// Returns the figures in rows of 5, 4 or 3, whichever fills the rows best. Fewer figures are in
/// one row.
std::string even_gallery(const std::vector<std::string>& figures) {
    const std::size_t count = figures.size();
    std::size_t best = std::max<std::size_t>(2, std::min<std::size_t>(count, 5));
    if (count > 5) {
        const auto empty = [&](std::size_t columns) {
            return (columns - count % columns) % columns;
        };
        for (const std::size_t columns : {4, 3})
            if (empty(columns) < empty(best)) best = columns;
    }
    std::string html = fmt::format("<div class=\"even\" style=\"--columns:{}\">\n", best);
    for (const std::string& figure : figures)
        html += figure;
    return html + "</div>\n";
}

/// Returns the sentences of a case, and its expected word.
std::string sought(const Json& row) {
    const std::string expect = row.value("expect", "");
    return fmt::format("<p class=\"lede sought\">\u201c{}\u201d \u2192 \u201c{}\u201d{}</p>\n",
                       html_escape(text_of(row, "from")), html_escape(text_of(row, "to")),
                       expect.empty() ? "" : " \u00b7 expected: " + html_escape(expect));
}

/// Returns the images of a run's folder in a column. The column is a link to `link`, unless that is
/// empty.
std::string run_figure(const Json& row, const char* key, const fs::path& output,
                       const std::string& link, const std::string& caption) {
    const std::string folder = text_of(row, "folder");
    std::string html = "<figure>";
    if (!link.empty()) html += "<a href=\"" + html_escape(link) + "\">";
    for (const Json& image : row.at(key))
        html += fmt::format("<img src=\"{}\" alt=\"{}\" title=\"{}\" loading=\"lazy\">",
                            data_uri(read_bytes(output / folder / text_of(image, "file"))),
                            html_escape(text_of(row, "method") + ", " + text_of(image, "caption")),
                            html_escape(text_of(image, "caption")));
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
        caption +=
            fmt::format(" \u00b7 <span class=\"wrong\">wanted {}, looks like {}</span>",
                        html_escape(row.value("expect", "")), html_escape(text_of(row, "found")));
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
                "<p class=\"lede\">{} runs, {}. <a href=\"table.csv\">table.csv</a> lists "
                "each run, <a href=\"table.tex\">table.tex</a> contains the table below.</p>\n",
                rows.size(),
                failed > 0 ? fmt::format("<a href=\"#failed\">{} failed</a>", failed)
                           : std::string("none failed")));
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
            const Json& images = ended->at("pictures_before");
            for (const Json& image : images)
                if (images.size() > 1)
                    caption += " \u00b7 " + html_escape(text_of(image, "caption"));
            figures.push_back(run_figure(*ended, "pictures_before", output, "", caption));
        }
        for (const Json& row : one.rows) {
            const std::string name = name_of(row, priors, seeds);
            figures.push_back(row.contains("error") ? failure_note(name)
                                                    : result_figure(row, output, name));
        }
        body += html_section(one.name, sought(one.rows.front()) + even_gallery(figures));
    }
    if (failed > 0)
        body += html_section(
            "Failed", "<div id=\"failed\" class=\"gallery\" style=\"--least:420px\">\n" + failures +
                          "</div>\n");
    body += "<footer><p><code>" + html_escape(command) + "</code></p><p>item3d " +
            html_escape(version()) + "</p></footer>\n";
    return html_page("Comparison of methods", body);
}

}  // namespace item3d
