#include "item3d/studio/live_folder.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace item3d {

namespace fs = std::filesystem;

namespace {

bool is_texture(const nlohmann::json& texture) {
    return texture.is_object() && texture.value("file", nlohmann::json()).is_string();
}

bool is_preview(const nlohmann::json& preview) {
    if (!preview.is_object()) return false;
    const nlohmann::json textures = preview.value("textures", nlohmann::json());
    return preview.value("revision", nlohmann::json()).is_number_integer() && textures.is_array() &&
           std::all_of(textures.begin(), textures.end(), is_texture);
}

}  // namespace

void LiveFolder::clear() const {
    for (const char* name : {progress_file_name, textures_file_name}) {
        std::error_code ignored;
        fs::remove(folder_ / name, ignored);
    }
}

bool LiveFolder::is_new(const char* name, fs::file_time_type& last) const {
    std::error_code code;
    const auto time = fs::last_write_time(folder_ / name, code);
    if (code || time == last) return false;
    last = time;
    return true;
}

std::optional<nlohmann::json> LiveFolder::new_progress() {
    if (!is_new(progress_file_name, progress_time_)) return std::nullopt;
    return read_progress(folder_ / progress_file_name);
}

std::optional<nlohmann::json> LiveFolder::new_preview() {
    if (!is_new(textures_file_name, preview_time_)) return std::nullopt;
    nlohmann::json preview = parse_json(read_text(folder_ / textures_file_name));
    return is_preview(preview) ? std::optional(std::move(preview)) : std::nullopt;
}

std::string live_texture_url(std::int64_t result, const std::string& file, std::int64_t revision) {
    return fmt::format("api/results/{}/files/{}/{}?revision={}", result, live_folder_name, file,
                       revision);
}

}  // namespace item3d
