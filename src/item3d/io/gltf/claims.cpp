#include "item3d/io/gltf/claims.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/gltf/builder.h"
#include "item3d/provenance/image_packet.h"
#include "item3d/provenance/json_ld.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>

namespace item3d {
namespace {

std::optional<std::size_t> packet_index(const Json& json) {
    const Json* index = find_path(json, {"asset", "extensions", packets_extension, "packet"});
    const Json* packets = find_path(json, {"extensions", packets_extension, "packets"});
    if (!index || !packets || !index->is_number_unsigned() || !packets->is_array())
        return std::nullopt;
    const auto number = index->get<std::size_t>();
    return number < packets->size() ? std::optional(number) : std::nullopt;
}

/// Returns the number of the document's objects that refer to a packet.
int count_uses(const Json& value, std::size_t packet) {
    if (!value.is_structured()) return 0;
    const Json* own = find_path(value, {"extensions", packets_extension, "packet"});
    int uses = own && *own == packet ? 1 : 0;
    for (const Json& child : value)
        uses += count_uses(child, packet);
    return uses;
}

Json& object_at(Json& parent, const char* key) {
    Json& value = parent[key];
    if (!value.is_object()) value = Json::object();
    return value;
}

/// Returns the asset's packet. First copies it if other objects share it, and creates it if there
/// is none.
Json& own_packet(const SourceDocument& written, Json& json) {
    const auto index = packet_index(json);
    Json packet{{"@context", Json::object()}};
    bool is_own = false;
    if (index) {
        const Json& old = json["extensions"][packets_extension]["packets"][*index];
        if (is_json_ld_packet(old)) {
            packet = old;
            is_own = count_uses(json, *index) == 1;
        } else {
            warn(written.path.string() + ": " + read_json_ld(old).problem +
                 "; the edit gets a separate packet");
        }
    }
    Json& packets = object_at(object_at(json, "extensions"), packets_extension)["packets"];
    if (!packets.is_array()) packets = Json::array();
    if (is_own) return packets[*index];
    packets.push_back(std::move(packet));
    Json& asset = object_at(json, "asset");
    object_at(object_at(asset, "extensions"), packets_extension)["packet"] = packets.size() - 1;
    Json& used = json["extensionsUsed"];
    if (!used.is_array()) used = Json::array();
    if (std::find(used.begin(), used.end(), packets_extension) == used.end())
        used.push_back(packets_extension);
    return packets.back();
}

std::set<std::size_t> image_views(const Json& json) {
    std::set<std::size_t> views;
    const Json* images = find_path(json, {"images"});
    if (!images || !images->is_array()) return views;
    for (const Json& image : *images)
        if (const Json* view = find_path(image, {"bufferView"}); view && view->is_number_unsigned())
            views.insert(view->get<std::size_t>());
    return views;
}

/// Returns a buffer view's JSON with a hash of its bytes in place of their location.
Json content_of_view(const SourceDocument& document, Json view, const std::string& where) {
    try {
        view["sha256"] = sha256(byte_range(document, GltfObject(document, view, where)));
    } catch (const InputError&) {
        view["sha256"] = "unreadable";
    }
    view.erase("buffer");
    view.erase("byteOffset");
    constexpr const char* meshopt = "EXT_meshopt_compression";
    if (find_path(view, {"extensions", meshopt}) && !where.ends_with(meshopt))
        view["extensions"][meshopt] =
            content_of_view(document, view["extensions"][meshopt], where + "." + meshopt);
    return view;
}

std::string number_text(std::size_t number) {
    return std::to_string(number);
}

void replace_images(const std::vector<std::string>& hashes, const std::vector<ImageClaim>& claimed,
                    Json& json) {
    if (!json.contains("images")) return;
    for (std::size_t i = 0; i < hashes.size(); ++i) {
        Json& image = json["images"][i];
        if (!image.is_object()) continue;
        const bool is_claimed = std::any_of(claimed.begin(), claimed.end(), [&](const auto& one) {
            return one.image == number_text(i);
        });
        image.erase("uri");
        image.erase("bufferView");
        if (!is_claimed) image["sha256"] = hashes[i];
    }
}

}  // namespace

const Json* asset_packet(const Json& json) {
    const auto index = packet_index(json);
    return index ? &json["extensions"][packets_extension]["packets"][*index] : nullptr;
}

PacketMetadata read_asset_packet(const Json& json) {
    const Json* packet = asset_packet(json);
    return packet ? read_json_ld(*packet) : PacketMetadata();
}

std::string packet_of_texture(const SourceDocument& document, const GltfObject& texture_info) {
    const GltfObject root = root_of(document);
    const auto index = texture_info.index("index", root.list_size("textures"));
    if (!index) return "";
    const Json& texture = document.json["textures"][*index];
    std::vector<const Json*> sources{find_path(texture, {"source"})};
    for (const char* extension : {"KHR_texture_basisu", "EXT_texture_webp"})
        sources.push_back(find_path(texture, {"extensions", extension, "source"}));
    for (const Json* source : sources) {
        if (!source || !source->is_number_unsigned() ||
            source->get<std::size_t>() >= root.list_size("images"))
            continue;
        try {
            const Bytes bytes =
                read_image_bytes(document, source->get<std::size_t>(), Forgiving::silently);
            if (auto packet = find_packet(bytes)) return *packet;
        } catch (const InputError&) {
        }
    }
    return "";
}

std::vector<std::string> image_hashes(const SourceDocument& document) {
    const Json* images = find_path(document.json, {"images"});
    std::vector<std::string> hashes(images && images->is_array() ? images->size() : 0);
    for (std::size_t i = 0; i < hashes.size(); ++i) {
        try {
            hashes[i] = image_sha256(read_image_bytes(document, i, Forgiving::silently));
        } catch (const InputError&) {
        }
    }
    return hashes;
}

std::string document_sha256(const SourceDocument& document,
                            const std::vector<ImageClaim>& claimed) {
    Json json = document.json;
    if (const auto packet = packet_index(json))
        remove_claim(json["extensions"][packets_extension]["packets"][*packet]);
    replace_images(image_hashes(document), claimed, json);
    const std::set<std::size_t> images = image_views(document.json);
    if (Json* views = json.contains("bufferViews") ? &json["bufferViews"] : nullptr;
        views && views->is_array()) {
        for (std::size_t i = 0; i < views->size(); ++i)
            (*views)[i] = images.contains(i)
                              ? Json()
                              : content_of_view(document, (*views)[i], number_text(i));
        // Trailing views of images are dropped, because images in files of their own have no view.
        while (!views->empty() && views->back().is_null())
            views->erase(views->size() - 1);
    }
    json.erase("buffers");
    Json chunks = Json::array();
    for (const SourceDocument::Chunk& chunk : document.other_chunks)
        chunks.push_back({chunk.type, sha256(chunk.bytes)});
    json["chunks"] = std::move(chunks);
    // nlohmann::json sorts the keys, so their order does not change the hash.
    const nlohmann::json sorted = json;
    return sha256(sorted.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void put_claim(const Provenance& provenance, const SourceDocument& source,
               SourceDocument& written) {
    const nlohmann::json earlier = read_asset_packet(source.json).claim;
    std::set<std::string> kept;
    for (const std::string& hash : image_hashes(source))
        kept.insert(hash);
    for (const ImageClaim& image : images_of(earlier))
        kept.erase(image.sha256);
    std::vector<ImageClaim> images;
    const std::vector<std::string> hashes = image_hashes(written);
    for (std::size_t i = 0; i < hashes.size(); ++i) {
        if (hashes[i].empty() || kept.contains(hashes[i])) continue;
        const Json* name = find_path(written.json["images"][i], {"name"});
        images.push_back(
            {number_text(i), name && name->is_string() ? name->get<std::string>() : "", hashes[i]});
    }
    nlohmann::json claim = make_claim(join_edits(edits_of(earlier), provenance.edits), images);
    Json& packet = own_packet(written, written.json);
    put_claim(packet, claim);
    claim["document_sha256"] = document_sha256(written, images_of(claim));
    if (provenance.key) provenance.key->sign(claim);
    put_claim(packet, claim);
}

}  // namespace item3d
