// glTF document of one triangle with textures in files, for the tests of loaders and writers.
#pragma once

#include "item3d/io/resources.h"
#include "tests/support/io.h"

#include <algorithm>
#include <map>
#include <string>

namespace item3d::testing_support {

using OrderedJson = nlohmann::ordered_json;

/// Returns the image from which tests/data/scene/images/*.ktx2 were made: smooth, with one
/// checkered channel.
inline Image test_image(int channels, int width = 30, int height = 22) {
    Image image(width, height, channels);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float values[] = {static_cast<float>(std::min(8 * x, 255)) / 255.0f,
                                    static_cast<float>(std::max(255 - 10 * y, 0)) / 255.0f,
                                    (x / 8 + y / 8) % 2 ? 60.0f / 255.0f : 180.0f / 255.0f,
                                    static_cast<float>(std::max(255 - 8 * x, 0)) / 255.0f};
            for (int c = 0; c < channels; ++c)
                image.at(x, y, c) = values[c];
        }
    }
    return image;
}

/// Returns the mean of squared differences.
inline double mean_squared_error(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double difference = a.pixels[i] - b.pixels[i];
        sum += difference * difference;
    }
    return sum / static_cast<double>(a.pixels.size());
}

/// Writes a glTF document with one triangle for each entry of `materials`, and the files of
/// `images`. Image i of the document is the i-th file in the order of names.
inline void write_textured(const fs::path& path, const std::map<std::string, Bytes>& images,
                           const OrderedJson& textures, const OrderedJson& materials,
                           const OrderedJson& root = OrderedJson::object()) {
    const float triangle[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1,
                              0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(triangle),
                                              sizeof triangle);
    OrderedJson json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = {{{"mesh", 0}}};
    json["buffers"] = {{{"byteLength", bytes.size()},
                        {"uri", "data:application/octet-stream;base64," + encode_base64(bytes)}}};
    json["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 36}},
                           {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 24}},
                           {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 36}}};
    const auto accessor = [](int view, const char* type) {
        return OrderedJson{
            {"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", type}};
    };
    json["accessors"] = {accessor(0, "VEC3"), accessor(1, "VEC2"), accessor(2, "VEC3")};
    OrderedJson primitives = OrderedJson::array();
    for (std::size_t i = 0; i < materials.size(); ++i) {
        primitives.push_back(
            {{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"NORMAL", 2}}}, {"material", i}});
    }
    json["meshes"] = {{{"primitives", primitives}}};
    json["materials"] = materials;
    json["textures"] = textures;
    for (const auto& [name, content] : images) {
        json["images"].push_back({{"uri", name}});
        write_quickly(path.parent_path() / name, content);
    }
    json.update(root, true);
    write_atomically(path, std::string_view(json.dump()));
}

/// Returns materials for write_textured(); the base colour texture of material i is texture i.
inline OrderedJson textured_materials(int count) {
    OrderedJson materials = OrderedJson::array();
    for (int i = 0; i < count; ++i)
        materials.push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    return materials;
}

inline bool contains(const Bytes& bytes, const Bytes& part) {
    return std::search(bytes.begin(), bytes.end(), part.begin(), part.end()) != bytes.end();
}

inline const Texture& base_color_of(const Model& model, std::size_t material) {
    return model.textures.at(
        static_cast<std::size_t>(model.materials.at(material).base_color_texture));
}

}  // namespace item3d::testing_support
