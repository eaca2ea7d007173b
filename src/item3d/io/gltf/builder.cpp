#include "item3d/io/gltf/builder.h"

#include "item3d/core/error.h"
#include "item3d/io/file_names.h"
#include "item3d/io/resources.h"
#include "item3d/io/text.h"
#include "item3d/io/texture_format.h"

#include <algorithm>
#include <cstring>

namespace item3d {
namespace {

constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;

// Converts integers to integers, and floats so that they read back exactly.
Json to_json_number(const Accessor& accessor, double value) {
    if (accessor.component_type == ComponentType::f32) return Json(value);
    return Json(static_cast<std::int64_t>(value));
}

}  // namespace

std::size_t append(Json& object, const char* key, Json value) {
    Json& list = object[key];
    if (!list.is_array()) list = Json::array();
    list.push_back(std::move(value));
    return list.size() - 1;
}

GltfBuilder::GltfBuilder(Json& json, std::size_t buffer, Bytes binary, bool images_in_files,
                         std::string stem)
    : json_(json),
      buffer_(buffer),
      binary_(std::move(binary)),
      size_before_(binary_.size()),
      images_in_files_(images_in_files),
      stem_(std::move(stem)) {}

std::size_t GltfBuilder::add_view(std::span<const std::uint8_t> bytes, int target,
                                  std::size_t stride) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    Json view{{"buffer", buffer_}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
    if (stride) view["byteStride"] = stride;
    if (target) view["target"] = target;
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    return append(json_, "bufferViews", std::move(view));
}

std::size_t GltfBuilder::add_vertices(const Accessor& shape, const Bytes& elements,
                                      bool with_bounds) {
    const std::size_t size = shape.element_size;
    const std::size_t stride = (size + 3) / 4 * 4;
    const std::size_t count = elements.size() / size;
    Bytes padded(count * stride, 0);
    for (std::size_t i = 0; i < count; ++i) {
        std::memcpy(padded.data() + i * stride, elements.data() + i * size, size);
    }
    Json accessor{{"bufferView", add_view(padded, array_buffer, stride == size ? 0 : stride)},
                  {"componentType", static_cast<int>(shape.component_type)}};
    if (shape.normalized) accessor["normalized"] = true;
    accessor["count"] = count;
    accessor["type"] = shape.type;
    if (with_bounds && count > 0) {
        Accessor values = shape;
        values.count = count;
        values.bytes = elements;
        Json low = Json::array();
        Json high = Json::array();
        for (std::size_t c = 0; c < shape.components; ++c) {
            double minimum = values.raw(0, c);
            double maximum = minimum;
            for (std::size_t i = 1; i < count; ++i) {
                minimum = std::min(minimum, values.raw(i, c));
                maximum = std::max(maximum, values.raw(i, c));
            }
            low.push_back(to_json_number(shape, minimum));
            high.push_back(to_json_number(shape, maximum));
        }
        accessor["min"] = std::move(low);
        accessor["max"] = std::move(high);
    }
    return append(json_, "accessors", std::move(accessor));
}

std::size_t GltfBuilder::add_floats(std::span<const float> values, std::size_t components,
                                    bool with_bounds) {
    static const char* const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    Accessor shape;
    shape.type = types[components - 1];
    shape.components = components;
    shape.element_size = components * sizeof(float);
    Bytes bytes(values.size_bytes());
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return add_vertices(shape, bytes, with_bounds);
}

std::size_t GltfBuilder::add_indices(std::span<const std::uint32_t> indices,
                                     std::size_t vertex_count) {
    // The largest value of an index type is reserved for primitive restart.
    const bool is_short = vertex_count <= 65535;
    Bytes bytes(indices.size() * (is_short ? 2 : 4));
    for (std::size_t i = 0; i < indices.size(); ++i) {
        if (is_short) {
            const auto value = static_cast<std::uint16_t>(indices[i]);
            std::memcpy(bytes.data() + 2 * i, &value, 2);
        } else {
            std::memcpy(bytes.data() + 4 * i, &indices[i], 4);
        }
    }
    const auto type = is_short ? ComponentType::u16 : ComponentType::u32;
    return append(json_, "accessors",
                  Json{{"bufferView", add_view(bytes, element_array_buffer)},
                       {"componentType", static_cast<int>(type)},
                       {"count", indices.size()},
                       {"type", "SCALAR"}});
}

std::string GltfBuilder::unused_file_name(const std::string& stem,
                                          const std::string& extension) const {
    for (int attempt = 0;; ++attempt) {
        const std::string name =
            stem + (attempt == 0 ? "" : "_" + std::to_string(attempt)) + extension;
        bool used = std::any_of(files_.begin(), files_.end(), [&](const auto& file) {
            return to_lower(file.first) == to_lower(name);
        });
        for (const char* list : {"images", "buffers"}) {
            if (!json_.contains(list)) continue;
            for (const Json& item : json_[list]) {
                const auto uri = item.find("uri");
                used = used || (uri != item.end() && uri->is_string() &&
                                to_lower(uri->get<std::string>()) == to_lower(path_to_uri(name)));
            }
        }
        if (!used) return name;
    }
}

std::size_t GltfBuilder::add_image(const Bytes& bytes, ImageEncoding encoding,
                                   const std::string& name) {
    Json image = Json::object();
    if (!name.empty()) image["name"] = name;
    if (images_in_files_) {
        const std::string file = unused_file_name(
            stem_ + "_" + plain_file_name(name.empty() ? "texture" : name), extension_of(encoding));
        image["uri"] = path_to_uri(file);
        files_[file] = bytes;
    } else {
        embed_image(image, bytes,
                    encoding == ImageEncoding::webp   ? "image/webp"
                    : encoding == ImageEncoding::ktx2 ? "image/ktx2"
                    : encoding == ImageEncoding::jpeg ? "image/jpeg"
                                                      : "image/png");
    }
    return append(json_, "images", std::move(image));
}

std::size_t GltfBuilder::add_texture(const Bytes& bytes, ImageEncoding encoding,
                                     const std::string& name, int sampler) {
    const char* extension = encoding == ImageEncoding::webp   ? "EXT_texture_webp"
                            : encoding == ImageEncoding::ktx2 ? "KHR_texture_basisu"
                                                              : nullptr;
    Json texture = Json::object();
    if (sampler >= 0) texture["sampler"] = sampler;
    const std::size_t source = add_image(bytes, encoding, name);
    if (extension != nullptr) {
        texture["extensions"][extension]["source"] = source;
    } else {
        texture["source"] = source;
    }
    return append(json_, "textures", std::move(texture));
}

std::size_t GltfBuilder::add_texture(const EditedTexture& image, const std::string& name,
                                     int sampler) {
    const std::pair key(image.identity(), sampler);
    const auto found = edited_.find(key);
    if (found != edited_.end()) return found->second;
    return edited_[key] = add_texture(image.encoded(), image.coding().encoding, name, sampler);
}

void GltfBuilder::embed_image(Json& image, const Bytes& bytes, const std::string& mime_type) {
    image.erase("uri");
    image["mimeType"] = mime_type;
    image["bufferView"] = add_view(bytes);
}

void GltfBuilder::replace_binary(Bytes binary) {
    binary_ = std::move(binary);
    is_cut_ = true;
}

void GltfBuilder::finish() {
    if (binary_.size() == size_before_ && !is_cut_) return;
    const bool is_new = !json_.contains("buffers") || json_["buffers"].size() <= buffer_;
    if (is_new) append(json_, "buffers", Json::object());
    json_["buffers"][buffer_]["byteLength"] = binary_.size();
}

}  // namespace item3d
