#include "item3d/io/gltf/texture_source.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/io/image/formats.h"

#include <algorithm>
#include <optional>

namespace item3d {
namespace {

/// Extensions in a viewer's order of preference.
constexpr const char* read_texture_extensions[] = {"KHR_texture_basisu", "EXT_texture_webp"};
constexpr const char* texture_extensions[] = {"KHR_texture_basisu", "EXT_texture_webp",
                                              "EXT_texture_avif", "MSFT_texture_dds"};

Texture read_texture(const SourceDocument& document, std::size_t index) {
    const GltfObject image = root_of(document).item("images", index);
    const std::string subject = document.path.string() + ": " + image.where();
    Texture texture = decode_texture(read_image_bytes(document, index), subject);
    texture.file.reset();  // already in the document
    texture.name = image.text("name", "");
    return texture;
}

[[noreturn]] void throw_without_image(const GltfObject& texture) {
    const auto extensions = texture.object("extensions");
    for (const char* name : texture_extensions) {
        if (extensions && extensions->has(name))
            texture.fail("has an image only in the extension " + std::string(name) +
                             ", which is not supported",
                         "convert its images to PNG, JPEG, WebP or KTX2");
    }
    texture.fail("has no image");
}

void set_listed(Json& json, const char* list, const char* name, bool is_listed) {
    const bool exists = json.contains(list) && json[list].is_array();
    if (!exists && !is_listed) return;
    Json& names = json[list];
    if (!exists) names = Json::array();
    const auto found = std::find(names.begin(), names.end(), name);
    if (is_listed && found == names.end()) names.push_back(name);
    if (!is_listed && found != names.end()) names.erase(found);
    if (names.empty()) json.erase(list);
}

}  // namespace

Texture read_texture_source(const SourceDocument& document, const GltfObject& texture) {
    const std::size_t images = root_of(document).list_size("images");
    std::vector<std::size_t> sources;
    if (const auto extensions = texture.object("extensions")) {
        for (const char* name : read_texture_extensions) {
            const auto extension = extensions->object(name);
            const auto source = extension ? extension->index("source", images) : std::nullopt;
            if (source) sources.push_back(*source);
        }
    }
    const auto plain = texture.index("source", images);
    if (plain) sources.push_back(*plain);
    if (sources.empty()) throw_without_image(texture);
    for (std::size_t i = 0;; ++i) {
        try {
            Texture result = read_texture(document, sources[i]);
            result.name = texture.text("name", result.name);
            // An edited copy gets the format of the texture's plain image, because viewers without
            // the extension can read that format.
            if (plain && sources[i] != *plain) {
                const ImageFormat format =
                    detect_image_format(read_image_bytes(document, *plain, Forgiving::silently));
                if (format == ImageFormat::png) result.coding = {};
                if (format == ImageFormat::jpeg) result.coding = {ImageEncoding::jpeg, false, 95};
            }
            return result;
        } catch (const InputError& error) {
            if (i + 1 == sources.size()) throw;
            warn(std::string(error.what()) + "; the texture's other image is used instead");
        }
    }
}

void list_texture_extensions(Json& json) {
    for (const char* name : texture_extensions) {
        bool is_used = false;
        bool is_required = false;
        if (json.contains("textures")) {
            for (const Json& texture : json["textures"]) {
                const auto extensions = texture.find("extensions");
                if (extensions == texture.end() || !extensions->contains(name)) continue;
                is_used = true;
                is_required = is_required || !texture.contains("source");
            }
        }
        set_listed(json, "extensionsUsed", name, is_used);
        set_listed(json, "extensionsRequired", name, is_required);
    }
}

}  // namespace item3d
