// Pieces of self-contained HTML pages: pictures are inside the page, nothing is fetched.
//
// Every function returns markup that is ready to be joined; texts that they are given are plain and
// are escaped here.
#pragma once

#include "item3d/core/data_uri.h"
#include "item3d/core/files.h"
#include "item3d/core/html_escape.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// An encoded picture (PNG, JPEG, WebP, GIF; told by its first bytes) and what it shows.
struct ReportImage {
    std::string caption;
    Bytes bytes;
};

using TableRows = std::vector<std::pair<std::string, std::string>>;

/// A picture with its caption below (none when empty). `checkered` shows what is transparent.
std::string html_figure(const ReportImage& image, bool checkered = false);
/// Figures in a grid whose columns are at least `least_width` CSS pixels wide.
std::string html_gallery(const std::vector<std::string>& figures, int least_width = 220);
/// Two pictures of one size, one over the other, with a handle that uncovers the second.
std::string html_comparison(const ReportImage& before, const ReportImage& after,
                            const std::string& caption);
/// Two columns: what, and its value.
std::string html_table(const TableRows& rows);
/// Horizontal bars with their share of the sum: seconds by stage.
std::string html_timings(const std::vector<std::pair<std::string, double>>& seconds);
/// Horizontal bars of parts in [0, 1], each with a remark (may be empty).
struct ReportPart {
    std::string name;
    double value = 0;
    std::string remark;
};
std::string html_parts(const std::vector<ReportPart>& parts);
/// The top of a page: what wrote it, small, and below that what it is about. `more` is markup.
std::string html_header(const std::string& program, const std::string& title,
                        const std::string& more = "");
/// A titled part of the page; nothing when `content` is empty.
std::string html_section(const std::string& title, const std::string& content);
/// The page around `body`, with its style and the few lines of script that it needs.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace item3d
