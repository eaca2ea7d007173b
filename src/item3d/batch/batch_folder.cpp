#include "item3d/batch/batch_folder.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"

#include <algorithm>
#include <random>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* mark_name = "batch.json";
constexpr const char* format_name = "item3d batch 1";
constexpr std::uintmax_t min_space = 1 << 20;

/// Throws InputError unless the mark is that of a known batch version.
void check_mark(const fs::path& folder) {
    const json mark = parse_json(read_text(folder / mark_name));
    const std::string format =
        mark.is_object() && mark.contains("format") && mark["format"].is_string()
            ? mark["format"].get<std::string>()
            : "";
    if (format != format_name)
        throw InputError((folder / mark_name).string(),
                         format.empty()
                             ? "is not a batch file"
                             : "has format '" + format + "', expected '" + format_name + "'",
                         "choose another folder");
}

/// True if a folder has only what an interrupted or unfinished create() leaves: empty folders and
/// temporary files.
bool is_half_made(const fs::path& folder) {
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder, code)) {
        const std::string name = entry.path().filename().string();
        const bool is_own = name == "jobs" || name == "workers" || name == "runs";
        const bool is_temporary = name.starts_with(".write-test-") || name.starts_with("batch.tmp");
        if (!is_temporary && !(is_own && fs::is_empty(entry.path(), code))) return false;
    }
    return !code;
}

bool is_marked(const fs::path& folder) {
    std::error_code code;
    if (!fs::exists(folder / mark_name, code)) return false;
    check_mark(folder);
    return true;
}

int number_of(const fs::path& file) {
    return static_cast<int>(std::strtol(file.filename().c_str(), nullptr, 10));
}

}  // namespace

std::string random_suffix() {
    std::random_device device;
    return fmt::format("{:04x}", device() & 0xffff);
}

bool BatchFolder::is_begun(const fs::path& path) {
    if (is_marked(path)) return true;
    std::error_code code;
    if (!fs::exists(path, code) || (fs::is_directory(path, code) && is_half_made(path)))
        return false;
    // Another process may have created the folder since then.
    if (!is_marked(path))
        throw InputError(path.string(), "contains files that do not belong to a batch",
                         "choose a new folder or the folder of a batch");
    return true;
}

BatchFolder BatchFolder::create(const fs::path& path) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    if (is_begun(whole)) return BatchFolder(whole);
    make_output_folder(whole);
    BatchFolder folder(whole);
    fs::create_directories(folder.jobs());
    fs::create_directories(folder.workers());
    fs::create_directories(whole / "runs");
    write_atomically(whole / mark_name,
                     std::string_view(json{{"format", format_name}}.dump() + "\n"));
    return folder;
}

BatchFolder BatchFolder::open(const fs::path& path) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    std::error_code code;
    if (!fs::exists(whole / mark_name, code))
        throw InputError(path.string(), "is not the folder of a batch",
                         "`item3d batch JOBS -o " + path.string() + "` creates one");
    check_mark(whole);
    return BatchFolder(whole);
}

void BatchFolder::add_jobs(const std::vector<BatchJob>& added) const {
    std::string lines;
    for (const BatchJob& job : added)
        lines += json(job).dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
    add_lines(lines);
}

void BatchFolder::remove_jobs(const std::vector<std::string>& keys) const {
    std::string lines;
    for (const std::string& key : keys)
        lines +=
            json{{removed_key, key}}.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
    add_lines(lines);
}

void BatchFolder::add_lines(const std::string& lines) const {
    if (lines.empty()) return;
    int last = 0;
    for (const auto& entry : fs::directory_iterator(jobs()))
        last = std::max(last, number_of(entry.path()));
    write_atomically(jobs() / fmt::format("{:06}-{}.jsonl", last + 1, random_suffix()),
                     std::string_view(lines));
}

bool BatchFolder::is_full() const {
    std::error_code code;
    const fs::space_info space = fs::space(path_, code);
    return !code && space.available < min_space;
}

}  // namespace item3d
