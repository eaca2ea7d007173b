#include "item3d/studio/static_files.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <zlib.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;

bool is_compressible(const std::string& type) {
    return type.starts_with("text/") || type.starts_with("application/json") ||
           type.starts_with("image/svg");
}

}  // namespace

std::string gzip(const std::string& text, int level) {
    constexpr int gzip_window = 15 + 16, memory_level = 8;
    z_stream stream{};
    ITEM3D_CHECK(deflateInit2(&stream, level, Z_DEFLATED, gzip_window, memory_level,
                              Z_DEFAULT_STRATEGY) == Z_OK,
                 "zlib cannot be initialized");
    std::string bytes(deflateBound(&stream, text.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    deflate(&stream, Z_FINISH);
    bytes.resize(stream.total_out);
    deflateEnd(&stream);
    return bytes;
}

std::string StaticFiles::compressed(const fs::path& file) {
    constexpr int level = 6;
    const auto time = fs::last_write_time(file);
    const std::lock_guard guard(mutex_);
    Compressed& kept = files_[file.string()];
    if (kept.bytes.empty() || kept.time != time) kept = {time, gzip(read_text(file), level)};
    return kept.bytes;
}

void StaticFiles::answer(const HttpRequest& request, HttpResponse& response,
                         const std::string& name) {
    const fs::path inside = fs::path(name).lexically_normal();
    bool is_inside = !inside.empty() && !inside.is_absolute();
    for (const fs::path& part : inside)
        is_inside = is_inside && !part.string().starts_with('.');
    const fs::path file = folder_ / inside;
    if (!is_inside || !fs::is_regular_file(file)) {
        reply_error(response, http_status::not_found, "no such file");
        return;
    }
    const std::string type = content_type(file);
    const bool takes_gzip =
        request.get_header_value("Accept-Encoding").find("gzip") != std::string::npos;
    if (!takes_gzip || !is_compressible(type)) {
        reply_file(request, response, file);
        return;
    }
    if (is_unchanged(request, response, file)) return;
    response.set_header("Content-Encoding", "gzip");
    response.set_header("Vary", "Accept-Encoding");
    reply_bytes(response, compressed(file), type);
}

}  // namespace item3d
