#include "item3d/report/html.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/report/html_style.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace item3d {

namespace {

bool starts_with(const Bytes& bytes, std::string_view magic, std::size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

std::string media_type(const Bytes& bytes) {
    if (starts_with(bytes, "\x89PNG")) return "image/png";
    if (starts_with(bytes, "\xff\xd8\xff")) return "image/jpeg";
    if (starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8)) return "image/webp";
    if (starts_with(bytes, "GIF8")) return "image/gif";
    return "application/octet-stream";
}

std::string base64(const Bytes& bytes) {
    static constexpr std::string_view alphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const unsigned group =
            bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
        text += alphabet[group >> 18 & 63];
        text += alphabet[group >> 12 & 63];
        text += left > 1 ? alphabet[group >> 6 & 63] : '=';
        text += left > 2 ? alphabet[group & 63] : '=';
    }
    return text;
}

std::string picture(const ReportImage& image, const std::string& attributes = "") {
    return fmt::format("<img src=\"{}\" alt=\"{}\"{}>", data_uri(image.bytes),
                       html_escape(image.caption), attributes);
}

}  // namespace

std::string data_uri(const Bytes& bytes) {
    return "data:" + media_type(bytes) + ";base64," + base64(bytes);
}

std::string html_figure(const ReportImage& image, bool checkered) {
    const std::string caption =
        image.caption.empty() ? "" : "<figcaption>" + html_escape(image.caption) + "</figcaption>";
    return fmt::format("<figure{}>{}{}</figure>\n", checkered ? " class=\"checkered\"" : "",
                       picture(image, " loading=\"lazy\""), caption);
}

std::string html_gallery(const std::vector<std::string>& figures, int least_width) {
    if (figures.empty()) return "";
    std::string body;
    for (const std::string& figure : figures)
        body += figure;
    return fmt::format("<div class=\"gallery\" style=\"--least:{}px\">\n{}</div>\n", least_width,
                       body);
}

std::string html_comparison(const ReportImage& before, const ReportImage& after,
                            const std::string& caption) {
    // Without script the range still shows the middle: before on the left, after on the right.
    return fmt::format(
        "<figure class=\"comparison\" style=\"--cut:50%\"><div>{}{}<span class=\"rule\"></span>"
        "<span class=\"tag left\">{}</span><span class=\"tag right\">{}</span>"
        "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
        "aria-label=\"Move between before and after\"></div>{}</figure>\n",
        picture(before), picture(after, " class=\"over\""), html_escape(before.caption),
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
