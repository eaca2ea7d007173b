#include "item3d/core/progress_file.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/core/replace_file.h"
#include "item3d/core/replaceable.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>

namespace item3d {
namespace {

using Clock = std::chrono::steady_clock;

/// The one progress file of the process.
struct ProgressFile {
    std::mutex mutex;
    std::string path;
    std::string stage;
    Clock::time_point written;
};

ProgressFile& progress_file() {
    static ProgressFile file;
    return file;
}

void write(ProgressFile& file, const nlohmann::json& progress) {
    try {
        replace_file(file.path, progress.dump());
    } catch (const Error& error) {
        warn(std::string("the progress is not written: ") + error.what());
        file.path.clear();
    }
}

/// True for an empty file, and for one that an earlier command wrote as its progress.
bool holds_progress(const std::filesystem::path& path) {
    constexpr std::uintmax_t max_size = 4096;
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(path, ignored);
    if (size == 0 || size > max_size) return size == 0;
    try {
        return read_progress(path).has_value();
    } catch (const InputError&) {
        return false;
    }
}

}  // namespace

void show_progress_in(const std::string& path) {
    check_replaceable(path);
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !holds_progress(path))
        throw InputError("--progress-file " + path, "exists and is not a progress file",
                         "choose another name");
    progress_file().path = path;
}

void show_stage(const std::string& stage) {
    show_steps(stage, 0, 0, 0, 0);
}

void show_steps(const std::string& stage, std::int64_t own, std::int64_t done, std::int64_t total,
                double seconds) {
    constexpr auto interval = std::chrono::milliseconds(330);
    ProgressFile& file = progress_file();
    const std::lock_guard guard(file.mutex);
    if (file.path.empty()) return;
    const auto now = Clock::now();
    if (stage == file.stage && done < total && now - file.written < interval) return;
    file.stage = stage;
    file.written = now;
    nlohmann::json progress = {{"stage", stage}, {"done", done}, {"total", total}};
    progress["seconds_left"] = nullptr;
    if (own > 0)
        progress["seconds_left"] =
            seconds * static_cast<double>(total - done) / static_cast<double>(own);
    write(file, progress);
}

std::optional<nlohmann::json> read_progress(const std::filesystem::path& path) {
    nlohmann::json progress = parse_json(read_text(path));
    if (!progress.is_object()) return std::nullopt;
    const auto value = [&](const char* key) { return progress.value(key, nlohmann::json()); };
    const bool is_whole = value("stage").is_string() && value("done").is_number_integer() &&
                          value("total").is_number_integer() &&
                          (value("seconds_left").is_number() || value("seconds_left").is_null());
    return is_whole ? std::optional(std::move(progress)) : std::nullopt;
}

}  // namespace item3d
