#include "item3d/io/gltf/unused_textures.h"

#include "item3d/core/progress.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>

namespace item3d {
namespace {

enum class IndexKind { texture, image, view };
using OnIndex = std::function<void(IndexKind, Json&)>;

constexpr const char* meshopt_name = "EXT_meshopt_compression";

bool is_index(const Json& value) {
    return value.is_number_integer() && value.get<std::int64_t>() >= 0;
}

// True if an object is a reference to a texture. In materials this is any object with an index;
// elsewhere its key or its members must be those of a texture info.
bool is_texture_reference(std::string_view key, const Json& object, bool in_material) {
    const auto index = object.find("index");
    if (index == object.end() || !is_index(*index)) return false;
    return in_material || key.ends_with("exture") || object.contains("texCoord") ||
           object.contains("channels");
}

void visit(Json& value, std::string_view key, bool in_material, const OnIndex& f) {
    if (value.is_array()) {
        for (Json& item : value)
            visit(item, key, in_material, f);
        return;
    }
    if (!value.is_object()) return;
    if (is_texture_reference(key, value, in_material)) f(IndexKind::texture, value["index"]);
    for (auto& [name, child] : value.items()) {
        if (name == "extras") continue;
        const bool is_view = name == "bufferView" || name == "values" || name == "arrayOffsets" ||
                             name == "stringOffsets";
        if (is_index(child)) {
            if (is_view) f(IndexKind::view, child);
            if (name == "thumbnailImage") f(IndexKind::image, child);
        } else if (name == "specularImages") {
            for (Json& faces : child)
                for (Json& face : faces)
                    if (is_index(face)) f(IndexKind::image, face);
        } else if (name == "textureProperties") {
            for (auto& [property, texture] : child.items())
                if (is_index(texture)) f(IndexKind::texture, texture);
        } else {
            visit(child, name, in_material, f);
        }
    }
}

// Calls f for every index of a texture, an image or a buffer view in a document.
void for_each_index(Json& root, const OnIndex& f) {
    for (auto& [name, value] : root.items()) {
        if (name == "textures") {
            for (Json& texture : value) {
                if (texture.contains("source")) f(IndexKind::image, texture["source"]);
                if (!texture.contains("extensions")) continue;
                for (auto& [extension, content] : texture["extensions"].items())
                    if (content.is_object() && content.contains("source"))
                        f(IndexKind::image, content["source"]);
            }
            continue;
        }
        if (name == "extensions" && value.contains("VRM") && value["VRM"].contains("meta") &&
            value["VRM"]["meta"].contains("texture") && is_index(value["VRM"]["meta"]["texture"]))
            f(IndexKind::texture, value["VRM"]["meta"]["texture"]);
        visit(value, name, name == "materials", f);
    }
}

// True if for_each_index() supports the references of all extensions in the document.
bool has_known_references(const Json& value) {
    static const std::set<std::string_view> known = {
        "EXT_texture_webp",
        "EXT_texture_avif",
        "EXT_meshopt_compression",
        "EXT_mesh_gpu_instancing",
        "EXT_mesh_features",
        "EXT_structural_metadata",
        "EXT_lights_image_based",
        "EXT_instance_features",
        "EXT_mesh_manifold",
        "EXT_lights_ies",
        "MSFT_texture_dds",
        "MSFT_lod",
        "MSFT_packing_normalRoughnessMetallic",
        "MSFT_packing_occlusionRoughnessMetallic",
        "VRM",
    };
    if (value.is_array()) return std::all_of(value.begin(), value.end(), has_known_references);
    if (!value.is_object()) return true;
    for (const auto& [key, child] : value.items()) {
        if (key == "extras") continue;
        if (key == "extensions" && child.is_object()) {
            for (const auto& [name, content] : child.items()) {
                if (!name.starts_with("KHR_") && !name.starts_with("VRMC_") &&
                    !known.contains(name))
                    return false;
            }
        }
        if (!has_known_references(child)) return false;
    }
    return true;
}

std::map<std::size_t, int> count_indices(Json& root, IndexKind kind) {
    std::map<std::size_t, int> counts;
    for_each_index(root, [&](IndexKind found, Json& index) {
        if (found == kind && is_index(index)) ++counts[index.get<std::size_t>()];
    });
    return counts;
}

// Erases the items of a list and updates all indices of that kind.
void erase_items(Json& root, const char* list, IndexKind kind, const std::set<std::size_t>& dead) {
    if (dead.empty()) return;
    for_each_index(root, [&](IndexKind found, Json& index) {
        if (found != kind || !is_index(index)) return;
        const auto old = index.get<std::size_t>();
        const auto before = std::distance(dead.begin(), dead.lower_bound(old));
        index = old - static_cast<std::size_t>(before);
    });
    Json left = Json::array();
    for (std::size_t i = 0; i < root[list].size(); ++i) {
        if (!dead.contains(i)) left.push_back(std::move(root[list][i]));
    }
    if (left.empty()) {
        root.erase(list);
    } else {
        root[list] = std::move(left);
    }
}

// Returns those of a list's first `size` items that were used before and are no longer used.
std::set<std::size_t> lost_items(const std::map<std::size_t, int>& before,
                                 const std::map<std::size_t, int>& now, std::size_t size) {
    std::set<std::size_t> lost;
    for (const auto& [index, count] : before) {
        if (index < size && !now.contains(index)) lost.insert(index);
    }
    return lost;
}

struct ByteRange {
    std::size_t begin;
    std::size_t end;
};

ByteRange range_of(const Json& view) {
    const auto begin = view.value("byteOffset", std::size_t{0});
    return {begin, begin + view.value("byteLength", std::size_t{0})};
}

void for_each_range(Json& root, std::size_t buffer, const std::function<void(Json&)>& f) {
    if (!root.contains("bufferViews")) return;
    for (Json& view : root["bufferViews"]) {
        if (view.value("buffer", std::size_t{0}) == buffer) f(view);
        if (!view.contains("extensions") || !view["extensions"].contains(meshopt_name)) continue;
        Json& compressed = view["extensions"][meshopt_name];
        if (compressed.value("buffer", std::size_t{0}) == buffer) f(compressed);
    }
}

// Removes the bytes of dead views from the buffer, in steps of eight to preserve alignment.
void cut_bytes(GltfBuilder& builder, const std::vector<ByteRange>& dead) {
    Json& root = builder.json();
    std::vector<ByteRange> live;
    for_each_range(root, builder.buffer(), [&](Json& view) { live.push_back(range_of(view)); });
    std::vector<ByteRange> cuts;
    for (ByteRange range : dead) {
        const bool is_shared = std::any_of(live.begin(), live.end(), [&](const ByteRange& other) {
            return other.begin < range.end && range.begin < other.end;
        });
        if (is_shared || range.end > builder.binary().size()) continue;
        range.end -= (range.end - range.begin) % 8;
        if (range.end > range.begin) cuts.push_back(range);
    }
    std::sort(cuts.begin(), cuts.end(),
              [](const ByteRange& a, const ByteRange& b) { return a.begin < b.begin; });
    Bytes binary;
    std::size_t at = 0;
    for (ByteRange& cut : cuts) {
        cut.begin = std::max(cut.begin, at);
        cut.end = std::max(cut.end, cut.begin);
        binary.insert(binary.end(), builder.binary().begin() + static_cast<std::ptrdiff_t>(at),
                      builder.binary().begin() + static_cast<std::ptrdiff_t>(cut.begin));
        at = cut.end;
    }
    if (cuts.empty()) return;
    binary.insert(binary.end(), builder.binary().begin() + static_cast<std::ptrdiff_t>(at),
                  builder.binary().end());
    for_each_range(root, builder.buffer(), [&](Json& view) {
        const std::size_t old = range_of(view).begin;
        std::size_t removed = 0;
        for (const ByteRange& cut : cuts) {
            if (cut.begin < old) removed += cut.end - cut.begin;
        }
        if (removed > 0) view["byteOffset"] = old - removed;
    });
    builder.replace_binary(std::move(binary));
}

}  // namespace

void remove_unused_textures(const SourceDocument& document, GltfBuilder& builder) {
    Json& root = builder.json();
    Json old = document.json;
    if (!old.contains("textures") || !old.contains("images")) return;
    const std::set<std::size_t> textures =
        lost_items(count_indices(old, IndexKind::texture), count_indices(root, IndexKind::texture),
                   old["textures"].size());
    if (textures.empty()) return;
    if (!has_known_references(old)) {
        note(document.path.string() +
             ": has unknown extensions, so images that the edit replaced are kept in the file");
        return;
    }
    erase_items(root, "textures", IndexKind::texture, textures);
    const std::set<std::size_t> images =
        lost_items(count_indices(old, IndexKind::image), count_indices(root, IndexKind::image),
                   old["images"].size());
    std::set<std::size_t> views;
    for (const std::size_t image : images) {
        const Json& item = root["images"][image];
        if (item.contains("bufferView") && is_index(item["bufferView"]))
            views.insert(item["bufferView"].get<std::size_t>());
    }
    erase_items(root, "images", IndexKind::image, images);
    const std::map<std::size_t, int> used = count_indices(root, IndexKind::view);
    std::vector<ByteRange> ranges;
    for (auto view = views.begin(); view != views.end();) {
        const bool is_used = used.contains(*view) || !root.contains("bufferViews") ||
                             *view >= root["bufferViews"].size();
        if (!is_used &&
            root["bufferViews"][*view].value("buffer", std::size_t{0}) == builder.buffer())
            ranges.push_back(range_of(root["bufferViews"][*view]));
        view = is_used ? views.erase(view) : std::next(view);
    }
    erase_items(root, "bufferViews", IndexKind::view, views);
    cut_bytes(builder, ranges);
}

}  // namespace item3d
