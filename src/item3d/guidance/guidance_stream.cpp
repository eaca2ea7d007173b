#include "item3d/guidance/guidance_stream.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"

#include <string>
#include <vector>

namespace item3d {
namespace {

constexpr std::size_t max_line = 4096;
constexpr std::int64_t max_views = 1024, min_side = 8, max_side = 4096;
constexpr std::int64_t max_floats = 250'000'000;  ///< 1 GB
constexpr const char* subject = "stdin";

/// Returns the next line without its newline. Returns no value at the end of the stream.
std::optional<std::string> read_line(const ReadBytes& read) {
    std::string line;
    for (char byte = 0; read(&byte, 1) == 1;) {
        if (byte == '\n') return line;
        line += byte;
        if (line.size() > max_line)
            throw InputError(subject, fmt::format("a line is longer than {} bytes", max_line));
    }
    if (line.empty()) return std::nullopt;
    throw InputError(subject, "ends within a line");
}

/// The JSON line of a request.
struct RequestHeader {
    std::int64_t iteration = 0, views = 0, height = 0, width = 0;
    bool depth = false, surface = false, reference = false;

    std::int64_t floats() const {
        return views * height * width *
               (3 + (depth ? 1 : 0) + (surface ? 6 : 0) + (reference ? 3 : 0));
    }
};

RequestHeader parse_header(const std::string& line) {
    RequestHeader header;
    try {
        const nlohmann::json json = parse_json_or_throw(line);
        header.iteration =
            integer_of(json.at("iteration"), 0, std::numeric_limits<std::int32_t>::max());
        header.views = integer_of(json.at("views"), 1, max_views);
        header.height = integer_of(json.at("height"), min_side, max_side);
        header.width = integer_of(json.at("width"), min_side, max_side);
        header.depth = json.value("depth", false);
        header.surface = json.value("surface", false);
        header.reference = json.value("reference", false);
    } catch (const nlohmann::json::exception&) {
        throw InputError(subject,
                         "a request's line is broken: an entry is missing or out of its range",
                         "see 'Guidance without a mesh' in docs/python.md");
    }
    if (header.surface && !header.depth)
        throw InputError(subject, "a request has a surface but no depth", "send both");
    if (header.floats() > max_floats)
        throw InputError(subject, "a request is larger than 1 GB", "send fewer or smaller images");
    return header;
}

at::Tensor read_floats(const ReadBytes& read, const char* name, at::IntArrayRef shape) {
    at::Tensor values = at::empty(shape, at::kFloat);
    auto* to = static_cast<char*>(values.mutable_data_ptr());
    for (std::size_t left = values.nbytes(); left > 0;) {
        const std::size_t count = read(to, left);
        if (count == 0) throw InputError(subject, fmt::format("ends within {}", name));
        to += count;
        left -= count;
    }
    if (!values.isfinite().all().item<bool>())
        throw InputError(subject, fmt::format("{} has numbers that are not finite", name));
    return values;
}

}  // namespace

std::optional<GuidanceRequest> read_guidance_request(const ReadBytes& read) {
    const std::optional<std::string> line = read_line(read);
    if (!line) return std::nullopt;
    const RequestHeader header = parse_header(*line);
    const std::int64_t n = header.views, h = header.height, w = header.width;
    GuidanceRequest request;
    request.iteration = header.iteration;
    request.input.images = read_floats(read, "images", {n, 3, h, w});
    if (header.depth) request.input.shape.depth = read_floats(read, "depth", {n, h, w});
    if (header.surface) {
        request.input.shape.position = read_floats(read, "position", {n, h, w, 3});
        request.input.shape.normal = read_floats(read, "normal", {n, h, w, 3});
    }
    if (header.reference) request.input.reference = read_floats(read, "reference", {n, 3, h, w});
    return request;
}

void write_guidance_reply(const WriteBytes& write, const nlohmann::json& line,
                          const at::Tensor& gradient) {
    const std::string text = line.dump() + "\n";
    write(text.data(), text.size());
    const at::Tensor values = gradient.to(at::kCPU, at::kFloat).contiguous();
    write(static_cast<const char*>(values.const_data_ptr()), values.nbytes());
}

}  // namespace item3d
