#include "item3d/edit/sequence/sequence_page.h"

#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/edit/outputs/baked_files.h"
#include "item3d/report/html.h"

#include <filesystem>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int sheet_width = 420;

std::string figure(const fs::path& image, const std::string& caption) {
    return html_figure({caption, read_bytes(image)});
}

std::string paragraph(const std::string& text) {
    return "<p>" + text + "</p>\n";
}

std::string selectors_of(const json& settings) {
    std::string text;
    for (const auto& [key, word] : {std::pair("region", ""), std::pair("exclude", "without ")})
        for (const json& selector : settings.value(key, json::array()))
            text += (text.empty() ? "" : ", ") + (word + selector.get<std::string>());
    return html_escape(text);
}

std::string region_text(const json& edit) {
    if (!edit.contains("region")) return paragraph("The whole surface may change.");
    const json& region = edit["region"];
    const std::string selectors = selectors_of(edit.value("settings", json::object()));
    return paragraph(fmt::format(
        "Region{}: {:.1f} % of the surface; outside the region, {} of {} texels changed.",
        selectors.empty() ? "" : " (" + selectors + ")", 100 * region["share"].get<double>(),
        region["outside"]["changed"].get<std::int64_t>(),
        region["outside"]["texels"].get<std::int64_t>()));
}

std::string edit_section(std::size_t number, const json& edit, const EditRequest& request) {
    std::vector<std::string> figures{figure(request.output / "before.png", "before"),
                                     figure(request.output / "after.png", "after")};
    const fs::path region = request.output / "region.png";
    if (edit.contains("region") && fs::exists(region))
        figures.insert(figures.begin() + 1, figure(region, "region"));
    const std::string folder = request.output.filename().string();
    std::string content = html_gallery(figures, sheet_width) + region_text(edit);
    content += paragraph(
        fmt::format("{} &middot; <a href=\"{}/report.html\">Report of this edit</a>",
                    format_duration(edit["seconds"]["total"].get<double>()), html_escape(folder)));
    return html_section(fmt::format("{}. {} \u2192 {}", number, request.plan.from, request.plan.to),
                        content);
}

}  // namespace

std::string sequence_page(const json& record, const std::vector<EditRequest>& edits) {
    const fs::path first = edits.front().output, last = edits.back().output;
    const std::string model = model_file_name(edits.back().model);
    const std::string title = fmt::format("{} edits", edits.size());
    std::string body = html_header(
        "item3d edit", title,
        paragraph(fmt::format("<a href=\"{0}\">{0}</a> contains all edits.", html_escape(model))));
    std::vector<std::string> whole{figure(first / "before.png", "before all"),
                                   figure(last / "after.png", "after all")};
    if (fs::exists(last / "turntable.webp"))
        whole.push_back(figure(last / "turntable.webp", "after all, turntable"));
    body += html_section("All", html_gallery(whole, sheet_width));
    for (std::size_t i = 0; i < edits.size(); ++i)
        body += edit_section(i + 1, record["edits"][i], edits[i]);
    return html_page("item3d edit", body);
}

}  // namespace item3d
