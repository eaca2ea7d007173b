#include "item3d/report/report.h"

#include "item3d/core/format.h"

#include <algorithm>

namespace item3d {

namespace {

/// Percent-encodes characters that a relative URL must not contain.
std::string url_path(const std::string& path) {
    std::string result;
    for (const char character : path) {
        const auto byte = static_cast<unsigned char>(character);
        const bool plain = std::isalnum(byte) || byte == '/' || byte == '.' || byte == '-' ||
                           byte == '_' || byte == '~';
        result += plain ? std::string(1, character) : fmt::format("%{:02X}", byte);
    }
    // The encoding above also escapes a colon. A browser would take the text before a colon as a
    // URL scheme.
    return result;
}

std::string header(const EditReport& report) {
    std::string html = fmt::format(
        "<header>\n<p class=\"kicker\">item3d edit \xc2\xb7 {}</p>\n"
        "<p class=\"sentences\"><del>{}</del><ins>{}</ins></p>\n",
        html_escape(report.model), html_escape(report.from), html_escape(report.to));
    if (!report.summary.empty()) {
        html += "<p class=\"lede\">" + html_escape(report.summary) + "</p>\n";
    }
    if (!report.files.empty()) {
        html += "<ul class=\"actions\">";
        for (const auto& [label, path] : report.files) {
            html +=
                fmt::format("<li><a href=\"{}\">{}</a></li>", url_path(path), html_escape(label));
        }
        html += "</ul>\n";
    }
    if (!report.warnings.empty()) {
        html += "<ul class=\"warnings\">";
        for (const std::string& warning : report.warnings) {
            html += "<li>" + html_escape(warning) + "</li>";
        }
        html += "</ul>\n";
    }
    return html + "</header>\n";
}

std::string views(const EditReport& report) {
    std::vector<std::string> figures;
    const std::size_t count = std::min(report.before.size(), report.after.size());
    for (std::size_t i = 0; i < count; ++i) {
        ReportImage before = report.before[i];
        ReportImage after = report.after[i];
        const std::string caption = before.caption;
        before.caption = "before";
        after.caption = "after";
        figures.push_back(html_comparison(before, after, caption));
    }
    // Up to four figures are large, with two in a row. More figures are smaller, with three in a
    // row.
    return html_gallery(figures, figures.size() <= 4 ? 420 : 300);
}

std::string region(const EditReport& report) {
    if (report.region.empty()) return "";
    std::vector<std::string> figures;
    for (const ReportImage& image : report.region)
        figures.push_back(html_figure(image));
    return "<p>" + html_escape(report.region_note) + "</p>\n" + html_gallery(figures, 140);
}

std::string scores(const EditReport& report) {
    if (report.scores.empty()) return "";
    std::string html = "<dl class=\"scores\">";
    for (const Score& score : report.scores) {
        html += fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>",
                            html_escape(score.name), html_escape(score.value),
                            html_escape(score.meaning));
    }
    return html + "</dl>\n";
}

std::string textures(const EditReport& report) {
    std::vector<std::string> figures;
    for (const TexturePair& texture : report.textures) {
        std::string pair = "<div class=\"pair\"><b>" + html_escape(texture.name) + "</b>";
        if (!texture.before.empty()) pair += html_figure({"before", texture.before}, true);
        if (!texture.after.empty()) pair += html_figure({"after", texture.after}, true);
        figures.push_back(pair + "</div>\n");
    }
    return html_gallery(figures, 300);
}

std::string timeline(const EditReport& report) {
    if (report.timeline.empty()) return "";
    std::string html;
    for (const TimelineEntry& entry : report.timeline) {
        html +=
            "<li><b>" + html_escape(entry.title) + "</b>" + html_figure({"", entry.image.bytes});
        if (!entry.caption.empty()) html += "<q>" + html_escape(entry.caption) + "</q>";
        html += "<dl>";
        for (const auto& [name, value] : entry.facts)
            html += fmt::format("<dt>{}</dt><dd>{}</dd>", html_escape(name), html_escape(value));
        html += "</dl></li>\n";
    }
    return "<ol class=\"timeline\">\n" + html + "</ol>\n<p>" + html_escape(report.timeline_note) +
           "</p>\n";
}

std::string charts(const EditReport& report) {
    if (report.charts.empty()) return "";
    std::string html;
    for (const Chart& chart : report.charts)
        html += html_chart(chart);
    return "<div class=\"charts\">\n" + html + "</div>\n";
}

std::string settings(const EditReport& report) {
    if (report.settings.empty()) return "";
    return "<div class=\"columns\">" + html_table(report.settings) + "</div>\n";
}

}  // namespace

std::string edit_report_html(const EditReport& report) {
    std::string body = header(report);
    body += html_section("Before and after", views(report));
    body += html_section("Region", region(report));
    // The scores are beside the turntable if both exist.
    std::string around = scores(report);
    if (report.turntable) {
        around = html_gallery({html_figure(*report.turntable), "<div>" + around + "</div>\n"}, 420);
    }
    body += html_section(report.turntable ? "Turntable" : "Scores", around);
    body += html_section("Textures", textures(report));
    body += html_section("Progress", timeline(report) + charts(report));
    body += html_section("Time per stage", html_timings(report.seconds));
    body += html_section("Settings", settings(report));
    body += "<footer>";
    if (!report.command.empty()) body += "<p><code>" + html_escape(report.command) + "</code></p>";
    body += "<p>item3d " + html_escape(report.version) + "</p></footer>\n";
    return html_page(report.from + " \xe2\x86\x92 " + report.to, body);
}

}  // namespace item3d
