#include "item3d/io/gltf/import_material.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/references.h"
#include "item3d/io/image/formats.h"

#include <utility>

namespace item3d {
namespace {

std::size_t list_size(const Json& json, const char* list) {
    return json.contains(list) ? json[list].size() : 0;
}

ImageEncoding encoding_of(const Bytes& bytes, const SourceDocument& document, std::size_t image) {
    switch (detect_image_format(bytes)) {
        case ImageFormat::png:
            return ImageEncoding::png;
        case ImageFormat::jpeg:
            return ImageEncoding::jpeg;
        case ImageFormat::webp:
            return ImageEncoding::webp;
        case ImageFormat::ktx2:
            return ImageEncoding::ktx2;
        default:
            break;
    }
    root_of(document).item("images", image).fail("is not a PNG, JPEG, WebP or KTX2");
}

std::string placed(const std::string& material, std::size_t uv_set) {
    return uv_set == 0 ? material : material + " in set " + std::to_string(uv_set);
}

}  // namespace

MaterialImport::MaterialImport(const DocumentContent& own, GltfBuilder& builder)
    : builder_(builder) {
    const Json& json = own.document().json;
    for (std::size_t i = 0; i < list_size(json, "materials"); ++i) {
        own_[i] = own.material(i);
        materials_.emplace(own_[i], i);
    }
    for (std::size_t i = 0; i < list_size(json, "textures"); ++i)
        textures_.emplace(own.texture(i), i);
    for (std::size_t i = 0; i < list_size(json, "images"); ++i)
        if (!own.image(i).empty()) images_.emplace(own.image(i), i);
}

std::size_t MaterialImport::add(const DocumentContent& content, std::size_t material,
                                std::size_t uv_set, const std::string& name) {
    const std::string key = content.material(material);
    // The equal material with the same index is preferred.
    const auto same = own_.find(material);
    if (uv_set == 0 && same != own_.end() && same->second == key) return material;
    const auto found = materials_.find(placed(key, uv_set));
    if (found != materials_.end()) return found->second;
    Json copy = content.document().json["materials"][material];
    for_each_texture_index(
        copy, [&](Json& index) { index = add_texture(content, index.get<std::size_t>()); });
    if (uv_set > 0) move_texture_coordinates(copy, uv_set);
    copy["name"] = name;
    const std::size_t index = append(builder_.json(), "materials", std::move(copy));
    return materials_[placed(key, uv_set)] = index;
}

std::size_t MaterialImport::add_default() {
    if (!default_) default_ = append(builder_.json(), "materials", Json{{"name", "default"}});
    return *default_;
}

std::size_t MaterialImport::add_texture(const DocumentContent& content, std::size_t index) {
    const std::string key = content.texture(index);
    const auto found = textures_.find(key);
    if (found != textures_.end()) return found->second;
    const Json& json = content.document().json;
    Json texture = json["textures"][index];
    if (texture.contains("sampler"))
        texture["sampler"] = add_sampler(json["samplers"][texture["sampler"].get<std::size_t>()]);
    if (texture.contains("source"))
        texture["source"] = add_image(content, texture["source"].get<std::size_t>());
    if (texture.contains("extensions"))
        for (auto& [name, extension] : texture["extensions"].items())
            if (extension.is_object() && extension.contains("source"))
                extension["source"] = add_image(content, extension["source"].get<std::size_t>());
    const std::size_t added = append(builder_.json(), "textures", std::move(texture));
    return textures_[key] = added;
}

std::size_t MaterialImport::add_image(const DocumentContent& content, std::size_t index) {
    const std::string& key = content.image(index);
    const auto found = images_.find(key);
    if (!key.empty() && found != images_.end()) return found->second;
    const SourceDocument& document = content.document();
    const Bytes bytes = read_image_bytes(document, index);
    const std::string name = root_of(document).item("images", index).text("name", "texture");
    const std::size_t added = builder_.add_image(bytes, encoding_of(bytes, document, index), name);
    return images_[key] = added;
}

std::size_t MaterialImport::add_sampler(const Json& sampler) {
    Json& json = builder_.json();
    for (std::size_t i = 0; i < list_size(json, "samplers"); ++i)
        if (json["samplers"][i] == sampler) return i;
    return append(json, "samplers", sampler);
}

}  // namespace item3d
