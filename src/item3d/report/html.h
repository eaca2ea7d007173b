// Building blocks of self-contained HTML pages, which embed their images and fetch nothing.
//
// Every function returns markup to be concatenated. Text arguments are plain text, which the
// functions escape.
#pragma once

#include "item3d/core/data_uri.h"
#include "item3d/core/files.h"
#include "item3d/core/html_escape.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Encoded image with a caption. Its format (PNG, JPEG, WebP or GIF) is recognized by its first
/// bytes.
struct ReportImage {
    std::string caption;
    Bytes bytes;
};

using TableRows = std::vector<std::pair<std::string, std::string>>;

/// Returns an image with its caption below, if the caption is not empty. checkered: true for a
/// chequerboard behind transparent parts.
std::string html_figure(const ReportImage& image, bool checkered = false);
/// Returns figures in a grid whose columns are at least `min_width` CSS pixels wide.
std::string html_gallery(const std::vector<std::string>& figures, int min_width = 220);
/// Returns two images of one size as an overlay with a handle that uncovers the second.
std::string html_comparison(const ReportImage& before, const ReportImage& after,
                            const std::string& caption);
/// Returns a table of two columns, name and value.
std::string html_table(const TableRows& rows);
/// Returns one horizontal bar for each stage, with its seconds and their fraction of the sum.
std::string html_timings(const std::vector<std::pair<std::string, double>>& seconds);
/// Horizontal bar of a fraction in [0, 1], with a remark, which may be empty.
struct ReportPart {
    std::string name;
    double value = 0;
    std::string remark;
};
std::string html_parts(const std::vector<ReportPart>& parts);
/// Returns the head of a page, with the program in small print and the title below it. `more` is
/// further markup.
std::string html_header(const std::string& program, const std::string& title,
                        const std::string& more = "");
/// Returns a titled section, or "" when `content` is empty.
std::string html_section(const std::string& title, const std::string& content);
/// Returns the page around `body`, with its style and a short script.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace item3d
