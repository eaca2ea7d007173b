#include "item3d/batch/gallery.h"

#include "item3d/batch/claim.h"
#include "item3d/batch/gallery_page.h"
#include "item3d/batch/worker.h"
#include "item3d/core/data_uri.h"
#include "item3d/core/files.h"
#include "item3d/core/html_escape.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t max_images_inside = 2000;

/// Returns the URL of a job's image for the page: a data URI if `inside`, else the file's relative
/// path. Null if the file is missing.
json image(const BatchFolder& folder, const std::string& within, const char* name, bool inside) {
    std::error_code code;
    const fs::path file = folder.path() / within / name;
    if (!fs::exists(file, code)) return nullptr;
    return inside ? data_uri(read_bytes(file)) : within + "/" + name;
}

json file_of(const BatchFolder& folder, const std::string& within, const std::string& name) {
    std::error_code code;
    if (name.empty() || !fs::exists(folder.path() / within / name, code)) return nullptr;
    return within + "/" + name;
}

/// Returns a job's options without its sentences: "seed 1, light sunset".
std::string options_text(const BatchJob& job) {
    std::string text;
    for (std::size_t i = 0; i < job.arguments.size(); ++i) {
        const std::string& name = job.arguments[i];
        if (!name.starts_with("--")) continue;
        const bool has_value =
            i + 1 < job.arguments.size() && !job.arguments[i + 1].starts_with("--");
        if (name == "--from" || name == "--to") continue;
        text += (text.empty() ? "" : ", ") + name.substr(2);
        if (has_value) text += " " + job.arguments[i + 1];
    }
    return text;
}

json card_of(const BatchFolder& folder, const BatchEntry& entry, bool inside) {
    const BatchJob& job = entry.job;
    json card = {{"title", job.name.empty() ? fs::path(job.model).filename().string() : job.name},
                 {"from", job.from},
                 {"to", job.to},
                 {"options", options_text(job)},
                 {"state", state_name(entry.state)},
                 {"attempts", entry.last.attempt},
                 {"seconds", entry.last.seconds}};
    if (!entry.last.message.empty()) card["message"] = entry.last.message;
    if (!entry.last.warnings.empty()) card["warnings"] = entry.last.warnings;
    if (job.name.empty() && job.model.empty()) card["title"] = job.place;
    if (entry.state != JobState::done) return card;
    const std::string within = job.folder + "/result";
    card["before"] = image(folder, within, before_thumbnail, inside);
    card["after"] = image(folder, within, after_thumbnail, inside);
    card["model"] = file_of(folder, within, model_in(folder.path() / within).filename().string());
    card["page"] = file_of(folder, within, job.command == "relight" ? "sheet.png" : "report.html");
    const json& outcome = entry.last.outcome;
    const json scores = outcome.is_object() ? outcome.value("scores", json::object()) : json();
    if (scores.is_object()) {
        if (scores.contains("detail_kept")) card["scores"]["detail kept"] = scores["detail_kept"];
        const json clip = scores.value("clip", json::object());
        if (clip.contains("global")) card["scores"]["CLIP, target"] = clip["global"];
        if (clip.contains("directional")) card["scores"]["CLIP, direction"] = clip["directional"];
    }
    return card;
}

/// Returns JSON that is safe within a script element.
std::string script_json(const json& value) {
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
        text.replace(at, 2, "<\\/");
    return text;
}

}  // namespace

std::string gallery_html(const BatchFolder& folder, const BatchView& view) {
    const auto& entries = view.entries();
    const auto done = std::count_if(entries.begin(), entries.end(), [](const BatchEntry& entry) {
        return entry.is_current() && entry.state == JobState::done;
    });
    const bool inside = static_cast<std::size_t>(done) <= max_images_inside;
    json cards = json::array();
    for (const BatchEntry& entry : entries)
        if (entry.is_current()) cards.push_back(card_of(folder, entry, inside));
    std::string page(gallery_page);
    const auto fill = [&](const std::string& mark, const std::string& text) {
        page.replace(page.find(mark), mark.size(), text);
    };
    fill("{{TITLE}}", html_escape(folder.path().filename().string()));
    fill("{{HEADING}}", html_escape(folder.path().filename().string()));
    fill("{{CARDS}}", script_json(cards));
    return page;
}

}  // namespace item3d
