#include "item3d/studio/live_folder.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"

#include <fmt/format.h>

namespace item3d {

namespace fs = std::filesystem;

void LiveFolder::clear() const {
    for (const char* name : {progress_file_name, textures_file_name}) {
        std::error_code ignored;
        fs::remove(folder_ / name, ignored);
    }
}

std::optional<nlohmann::json> LiveFolder::read_if_new(const char* name,
                                                      fs::file_time_type& last) const {
    const fs::path path = folder_ / name;
    std::error_code code;
    const auto time = fs::last_write_time(path, code);
    if (code || time == last) return std::nullopt;
    last = time;
    auto json = parse_json(read_text(path));
    if (!json.is_object()) return std::nullopt;
    return json;
}

std::optional<nlohmann::json> LiveFolder::new_progress() {
    return read_if_new(progress_file_name, progress_time_);
}

std::optional<nlohmann::json> LiveFolder::new_preview() {
    return read_if_new(textures_file_name, preview_time_);
}

std::string live_texture_url(std::int64_t result, const std::string& file, std::int64_t revision) {
    return fmt::format("api/results/{}/files/{}/{}?revision={}", result, live_folder_name, file,
                       revision);
}

}  // namespace item3d
