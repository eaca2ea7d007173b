#include "item3d/io/gltf/document.h"

#include "item3d/core/error.h"
#include "item3d/core/parse_json.h"
#include "item3d/io/find_file.h"
#include "item3d/io/gltf/meshopt.h"
#include "item3d/io/resources.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace item3d {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t json_chunk = 0x4e4f534a;
constexpr std::uint32_t binary_chunk = 0x004e4942;

std::uint32_t read_u32(const Bytes& bytes, std::size_t offset) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + offset, 4);
    return value;
}

// Returns the offset of the next chunk. Chunks start at multiples of four, but some programs write
// them without padding: after an unaligned length, the next chunk begins without padding if the
// bytes there can be a BIN chunk.
std::size_t next_chunk(const Bytes& bytes, std::size_t end, std::size_t length) {
    const bool is_unpadded = end % 4 != 0 && end + 8 <= length &&
                             read_u32(bytes, end + 4) == binary_chunk &&
                             read_u32(bytes, end) <= length - end - 8;
    return is_unpadded ? end : (end + 3) / 4 * 4;
}

// Fills the document's chunks and returns the JSON text.
std::string_view read_container(const Bytes& bytes, SourceDocument& document,
                                std::optional<Bytes>& binary) {
    const std::string subject = document.path.string();
    const std::string hint = "the file is damaged or cut short; export it again";
    if (bytes.size() < 20) throw InputError(subject, "a .glb has at least 20 bytes", hint);
    const std::uint32_t version = read_u32(bytes, 4);
    if (version != 2) {
        throw InputError(subject,
                         fmt::format("expected a glTF 2.0 container, found version {}", version),
                         "convert it to glTF 2.0");
    }
    const std::size_t length = read_u32(bytes, 8);
    if (length > bytes.size()) {
        throw InputError(subject,
                         fmt::format("declares {} bytes, but has {}", length, bytes.size()), hint);
    }
    std::string_view text;
    for (std::size_t offset = 12; offset + 8 <= length;) {
        const std::size_t chunk_length = read_u32(bytes, offset);
        const std::uint32_t type = read_u32(bytes, offset + 4);
        const bool is_first = offset == 12;
        offset += 8;
        if (chunk_length > length - offset) {
            throw InputError(
                subject, fmt::format("a chunk of {} bytes exceeds the file", chunk_length), hint);
        }
        if (is_first != (type == json_chunk)) {
            throw InputError(subject, "the first chunk of a .glb, and only this one, must be JSON",
                             hint);
        }
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
        const auto end = begin + static_cast<std::ptrdiff_t>(chunk_length);
        if (is_first) {
            text = std::string_view(reinterpret_cast<const char*>(bytes.data()) + offset,
                                    chunk_length);
        } else if (type == binary_chunk && !binary) {
            binary.emplace(begin, end);
        } else {
            document.other_chunks.push_back({type, Bytes(begin, end)});
        }
        offset = next_chunk(bytes, offset + chunk_length, length);
    }
    return text;
}

Json parse_json(std::string_view text, const std::string& subject) {
    try {
        Json json = parse_ordered_json_or_throw(text);
        if (json.is_object()) return json;
    } catch (const Json::exception&) {
        parse_json_text(std::string(text), subject);
    }
    throw InputError(subject, "expected a JSON object", "the file is not a glTF");
}

void read_buffers(SourceDocument& document, std::optional<Bytes> binary) {
    const GltfObject root = root_of(document);
    const std::string subject = document.path.string();
    for (std::size_t i = 0; i < root.list_size("buffers"); ++i) {
        const GltfObject buffer = root.item("buffers", i);
        Bytes bytes;
        if (buffer.has("uri")) {
            const std::string uri = buffer.text("uri", "");
            const std::string place = subject + ": " + buffer.where();
            bytes = is_data_uri(uri)
                        ? decode_data_uri(uri, place)
                        : read_bytes(resolve_uri(document.path.parent_path(), uri, place));
        } else if (i == 0 && binary) {
            bytes = std::move(*binary);
            document.has_binary_chunk = true;
        } else {
            // Some extensions define buffers without data. Reading such a buffer is an error.
            document.buffers.emplace_back();
            continue;
        }
        const std::size_t length = buffer.integer("byteLength");
        if (bytes.size() < length) {
            buffer.fail(fmt::format("declares {} bytes, but has {}", length, bytes.size()),
                        "the file is cut short");
        }
        document.buffers.push_back(std::move(bytes));
    }
}

}  // namespace

std::shared_ptr<SourceDocument> parse_gltf(const fs::path& path, const Bytes& bytes) {
    auto document = std::make_shared<SourceDocument>();
    document->path = path;
    std::optional<Bytes> binary;
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("glTF")) text = read_container(bytes, *document, binary);
    document->json = parse_json(text, path.string());

    const GltfObject root = root_of(*document);
    const auto asset = root.object("asset");
    const std::string version = asset ? asset->text("version", "") : "";
    const std::string needed = asset ? asset->text("minVersion", version) : "";
    if (!version.starts_with("2.") || !(needed == "2.0" || needed == version)) {
        throw InputError(path.string(),
                         "expected glTF 2.0, found " +
                             (version.empty() ? "no asset.version" : "version '" + version + "'"),
                         "convert it to glTF 2.0");
    }
    read_buffers(*document, std::move(binary));
    decode_meshopt_views(*document);
    return document;
}

GltfObject::GltfObject(const SourceDocument& document, const Json& json, std::string where)
    : document_(&document), json_(&json), where_(std::move(where)) {
    if (!json.is_object()) fail("expected an object");
}

void GltfObject::fail(const std::string& problem, const std::string& hint) const {
    throw InputError(document_->path.string(), (where_.empty() ? "" : where_ + ": ") + problem,
                     hint);
}

const Json* GltfObject::find(const char* key) const {
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

std::optional<GltfObject> GltfObject::object(const char* key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    return GltfObject(*document_, *value, where_.empty() ? key : where_ + "." + key);
}

std::string GltfObject::text(const char* key, const std::string& otherwise) const {
    const Json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_string()) fail(std::string(key) + " must be a string");
    return value->get<std::string>();
}

double GltfObject::number(const char* key, double otherwise) const {
    const Json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_number()) fail(std::string(key) + " must be a number");
    return value->get<double>();
}

bool GltfObject::boolean(const char* key, bool otherwise) const {
    const Json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_boolean()) fail(std::string(key) + " must be true or false");
    return value->get<bool>();
}

std::size_t GltfObject::to_integer(const Json& value, const std::string& place) const {
    const double number = value.is_number() ? value.get<double>() : -1.0;
    if (!(number >= 0.0 && number < 0x1p53) || number != std::floor(number)) {
        fail(place + " must be a non-negative integer");
    }
    return static_cast<std::size_t>(number);
}

std::size_t GltfObject::integer(const char* key, std::size_t otherwise) const {
    const Json* value = find(key);
    return value ? to_integer(*value, key) : otherwise;
}

std::size_t GltfObject::integer(const char* key) const {
    const Json* value = find(key);
    if (!value) fail(std::string(key) + " is missing");
    return to_integer(*value, key);
}

std::vector<double> GltfObject::numbers(const char* key, std::size_t count) const {
    const Json* value = find(key);
    if (!value) return {};
    std::vector<double> result;
    if (value->is_array()) {
        for (const Json& item : *value) {
            if (item.is_number()) result.push_back(item.get<double>());
        }
    }
    if (result.size() != count || value->size() != count) {
        fail(fmt::format("{} must be {} numbers", key, count));
    }
    return result;
}

std::size_t GltfObject::list_size(const char* key) const {
    const Json* value = find(key);
    if (!value) return 0;
    if (!value->is_array()) fail(std::string(key) + " must be a list");
    return value->size();
}

GltfObject GltfObject::item(const char* key, std::size_t index) const {
    if (index >= list_size(key)) fail(fmt::format("{} has no item {}", key, index));
    return GltfObject(*document_, (*json_)[key][index],
                      fmt::format("{}{}{}[{}]", where_, where_.empty() ? "" : ".", key, index));
}

std::size_t GltfObject::index_item(const char* key, std::size_t index, std::size_t limit) const {
    const std::size_t value = to_integer(find(key)->at(index), fmt::format("{}[{}]", key, index));
    if (value >= limit) fail(fmt::format("{}[{}] is {}, of {}", key, index, value, limit));
    return value;
}

std::optional<std::size_t> GltfObject::index(const char* key, std::size_t limit) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    const std::size_t result = to_integer(*value, key);
    if (result >= limit) fail(fmt::format("{} is {}, but there are {}", key, result, limit));
    return result;
}

GltfObject root_of(const SourceDocument& document) {
    return GltfObject(document, document.json, "");
}

std::span<const std::uint8_t> byte_range(const SourceDocument& document, const GltfObject& object) {
    const auto buffer = object.index("buffer", document.buffers.size());
    if (!buffer) object.fail("buffer is missing");
    const Bytes& bytes = document.buffers[*buffer];
    const std::size_t offset = object.integer("byteOffset", 0);
    const std::size_t length = object.integer("byteLength");
    if (offset > bytes.size() || length > bytes.size() - offset) {
        object.fail(fmt::format("bytes {} to {} exceed buffer {} of {} bytes", offset,
                                offset + length, *buffer, bytes.size()),
                    "the file is damaged or cut short; export it again");
    }
    return std::span(bytes).subspan(offset, length);
}

std::span<const std::uint8_t> buffer_view_bytes(const SourceDocument& document, std::size_t index) {
    const auto decoded = document.decoded_views.find(index);
    if (decoded != document.decoded_views.end()) return decoded->second;
    return byte_range(document, root_of(document).item("bufferViews", index));
}

Bytes read_image_bytes(const SourceDocument& document, std::size_t index, Forgiving forgiving) {
    const GltfObject image = root_of(document).item("images", index);
    const std::string place = document.path.string() + ": " + image.where();
    if (image.has("uri")) {
        const std::string uri = image.text("uri", "");
        if (is_data_uri(uri)) return decode_data_uri(uri, place);
        const fs::path folder = document.path.parent_path();
        try {
            return read_bytes(resolve_uri(folder, uri, place, forgiving));
        } catch (const InputError&) {
            const auto found = find_allowed(document.texture_folders, folder,
                                            fs::path(percent_decode(uri)), place);
            if (!found) throw;
            return read_bytes(*found);
        }
    }
    const auto view = image.index("bufferView", root_of(document).list_size("bufferViews"));
    if (!view) image.fail("uri and bufferView are both missing");
    const auto bytes = buffer_view_bytes(document, *view);
    return Bytes(bytes.begin(), bytes.end());
}

const Json* find_path(const Json& json, std::initializer_list<const char*> keys) {
    const Json* value = &json;
    for (const char* key : keys) {
        if (!value->is_object()) return nullptr;
        const auto found = value->find(key);
        if (found == value->end()) return nullptr;
        value = &*found;
    }
    return value;
}

}  // namespace item3d
