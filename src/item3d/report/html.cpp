#include "item3d/report/html.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/report/html_style.h"

#include <algorithm>
#include <string_view>

namespace item3d {

namespace {

std::string img_element(const ReportImage& image, const std::string& attributes = "") {
    return fmt::format("<img src=\"{}\" alt=\"{}\"{}>", data_uri(image.bytes),
                       html_escape(image.caption), attributes);
}

}  // namespace

std::string html_figure(const ReportImage& image, bool checkered) {
    const std::string caption =
        image.caption.empty() ? "" : "<figcaption>" + html_escape(image.caption) + "</figcaption>";
    return fmt::format("<figure{}>{}{}</figure>\n", checkered ? " class=\"checkered\"" : "",
                       img_element(image, " loading=\"lazy\""), caption);
}

std::string html_gallery(const std::vector<std::string>& figures, int min_width) {
    if (figures.empty()) return "";
    std::string body;
    for (const std::string& figure : figures)
        body += figure;
    return fmt::format("<div class=\"gallery\" style=\"--least:{}px\">\n{}</div>\n", min_width,
                       body);
}

std::string html_comparison(const ReportImage& before, const ReportImage& after,
                            const std::string& caption) {
    // Without JavaScript the slider stays in the middle, with `before` on the left and `after` on
    // the right.
    return fmt::format(
        "<figure class=\"comparison\" style=\"--cut:50%\"><div>{}{}<span class=\"rule\"></span>"
        "<span class=\"tag left\">{}</span><span class=\"tag right\">{}</span>"
        "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
        "aria-label=\"Move between before and after\"></div>{}</figure>\n",
        img_element(before), img_element(after, " class=\"over\""), html_escape(before.caption),
        html_escape(after.caption),
        caption.empty() ? "" : "<figcaption>" + html_escape(caption) + "</figcaption>");
}

std::string html_table(const TableRows& rows) {
    if (rows.empty()) return "";
    std::string body;
    for (const auto& [name, value] : rows) {
        body += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", html_escape(name),
                            html_escape(value));
    }
    return "<table class=\"facts\">\n" + body + "</table>\n";
}

std::string html_timings(const std::vector<std::pair<std::string, double>>& seconds) {
    double sum = 0;
    double longest = 0;
    for (const auto& [name, value] : seconds) {
        sum += value;
        longest = std::max(longest, value);
    }
    if (sum <= 0) return "";
    std::string body;
    for (const auto& [name, value] : seconds) {
        const std::string time =
            value < 10 ? fmt::format("{:.2f} s", value) : format_duration(value);
        body += fmt::format(
            "<li><span>{}</span><i style=\"--part:{:.2f}%\"></i><b>{}</b><em>{:.0f} %</em></li>\n",
            html_escape(name), 100 * value / longest, time, 100 * value / sum);
    }
    return "<ol class=\"timings\">\n" + body + "</ol>\n";
}

std::string html_parts(const std::vector<ReportPart>& parts) {
    std::string body;
    for (const ReportPart& part : parts)
        body += fmt::format(
            "<li><span>{}</span><i style=\"--part:{:.2f}%\"></i><b>{:.0f} %</b><em>{}</em></li>\n",
            html_escape(part.name), 100 * part.value, 100 * part.value, html_escape(part.remark));
    return "<ol class=\"timings parts\">\n" + body + "</ol>\n";
}

std::string html_header(const std::string& program, const std::string& title,
                        const std::string& more) {
    return fmt::format(
        "<header>\n<p class=\"kicker\">{}</p>\n<p class=\"sentences\">{}</p>\n{}</header>\n",
        html_escape(program), html_escape(title), more);
}

std::string html_section(const std::string& title, const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section><h2>{}</h2>\n{}</section>\n", html_escape(title), content);
}

std::string html_page(const std::string& title, const std::string& body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n"
        "<script>{}</script>\n</body>\n</html>\n",
        html_escape(title), html_style, body, html_script);
}

}  // namespace item3d
