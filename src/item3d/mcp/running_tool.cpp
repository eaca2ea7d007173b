#include "item3d/mcp/running_tool.h"

#include "item3d/core/data_uri.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/core/progress_file.h"

#include <sys/wait.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t max_picture_bytes = 2 << 20;  ///< agents receive images as base64

/// Returns the JSON object printed by --json, after any warnings.
json printed_json(const std::string& log) {
    const std::size_t start = log.starts_with("{") ? 0 : log.find("\n{");
    if (start == std::string::npos) return json::object();
    json value = parse_json(log.substr(start));
    return value.is_object() ? value : json::object();
}

json warnings_of(const std::string& log) {
    json warnings = json::array();
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line) && !line.starts_with("{");)
        if (!line.empty()) warnings.push_back(line);
    return warnings;
}

std::string media_type(const fs::path& file) {
    const std::string extension = file.extension().string();
    if (extension == ".png") return "image/png";
    if (extension == ".webp") return "image/webp";
    if (extension == ".glb") return "model/gltf-binary";
    if (extension == ".html") return "text/html";
    if (extension == ".json") return "application/json";
    if (extension == ".hdr") return "image/vnd.radiance";
    return "application/octet-stream";
}

/// Returns "file:///..." with percent-encoding.
std::string file_uri(const fs::path& file) {
    std::string uri = "file://";
    for (const char character : file.string()) {
        const auto byte = static_cast<unsigned char>(character);
        const bool is_plain = std::isalnum(byte) ||
                              std::string_view("/-._~").find(character) != std::string_view::npos;
        uri += is_plain ? std::string(1, character) : fmt::format("%{:02X}", byte);
    }
    return uri;
}

json image_content(const fs::path& file) {
    const std::string uri = data_uri(read_bytes(file));
    return {
        {"type", "image"}, {"data", uri.substr(uri.find(',') + 1)}, {"mimeType", media_type(file)}};
}

}  // namespace

json failed_call(const std::string& message) {
    return {{"isError", true}, {"content", json::array({{{"type", "text"}, {"text", message}}})}};
}

RunningTool::RunningTool(ToolCommand command, const fs::path& launcher, const fs::path& scratch)
    : command_(std::move(command)), scratch_(scratch) {
    make_output_folder(scratch_);
    std::vector<std::string> arguments{launcher.string(), command_.arguments.front(), "--json",
                                       "--quiet",
                                       "--progress-file=" + (scratch_ / "progress.json").string()};
    arguments.insert(arguments.end(), command_.arguments.begin() + 1, command_.arguments.end());
    program_ = std::make_unique<ChildProgram>(arguments, scratch_ / "log.txt");
}

RunningTool::~RunningTool() {
    program_.reset();
    std::error_code ignored;
    fs::remove_all(scratch_, ignored);
}

std::optional<ToolProgress> RunningTool::progress() {
    const fs::path file = scratch_ / "progress.json";
    std::error_code code;
    if (!fs::exists(file, code)) return std::nullopt;
    const auto now = read_progress(file);
    if (!now) return std::nullopt;
    const auto stage = now->at("stage").get<std::string>();
    const auto done = now->at("done").get<std::int64_t>(),
               total = now->at("total").get<std::int64_t>();
    if (stage == stage_ && done <= done_) return std::nullopt;
    if (stage != stage_) before_ += done_ + 1;
    stage_ = stage;
    done_ = done;
    ToolProgress progress{before_ + done_, stage};
    if (total > 0) progress.message += fmt::format(": {} of {}", done, total);
    if (const auto left = now->find("seconds_left"); left != now->end() && left->is_number())
        progress.message += ", " + format_duration(left->get<double>()) + " left";
    return progress;
}

json RunningTool::success() const {
    const std::string log = read_text(scratch_ / "log.txt");
    json facts = printed_json(log);
    if (const json warnings = warnings_of(log); !warnings.empty()) facts["warnings"] = warnings;
    json content = json::array();
    if (!command_.result.empty()) facts["folder"] = command_.result.string();
    content.push_back({{"type", "text"}, {"text", facts.dump(1)}});
    std::error_code code;
    for (const std::string_view name : command_.tool->images) {
        const fs::path file = command_.result / name;
        if (fs::exists(file, code) && fs::file_size(file, code) <= max_picture_bytes)
            content.push_back(image_content(file));
    }
    for (const std::string_view name : command_.tool->files) {
        const fs::path file = command_.result / name;
        if (fs::exists(file, code))
            content.push_back({{"type", "resource_link"},
                               {"uri", file_uri(file)},
                               {"name", name},
                               {"mimeType", media_type(file)}});
    }
    return {{"content", content}, {"structuredContent", facts}, {"isError", false}};
}

std::optional<json> RunningTool::result() {
    const auto status = program_->status();
    if (!status) return std::nullopt;
    if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return success();
    return failed_call(reason_of_end(scratch_ / "log.txt", *status));
}

}  // namespace item3d
