// Live state of a running command, in the folder live/ of its result.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace item3d {

inline constexpr const char* live_folder_name = "live";
inline constexpr const char* progress_file_name = "progress.json";
inline constexpr const char* textures_file_name = "textures.json";

/// Reader of progress.json and textures.json. It returns each version of a file once.
class LiveFolder {
  public:
    LiveFolder() = default;
    explicit LiveFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Removes the files of an earlier run.
    void clear() const;
    /// Returns "stage", "done", "total" and "seconds_left"; nullopt if they have not changed or are
    /// damaged (read_progress).
    std::optional<nlohmann::json> new_progress();
    /// Returns "revision", "textures" ([{"material", "slot", "file"}]) and "direction"; nullopt if
    /// they have not changed or are damaged.
    std::optional<nlohmann::json> new_preview();

  private:
    bool is_new(const char* name, std::filesystem::file_time_type& last) const;

    std::filesystem::path folder_;
    std::filesystem::file_time_type progress_time_, preview_time_;
};

/// Returns the address of a texture of the live folder, relative to the page. file, revision:
/// values from new_preview().
std::string live_texture_url(std::int64_t result, const std::string& file, std::int64_t revision);

}  // namespace item3d
