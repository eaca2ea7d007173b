// glTF document of a square of two triangles, which tests can change and write.
#pragma once

#include "item3d/io/image/png.h"
#include "item3d/io/resources.h"
#include "tests/support/io.h"

#include <cstring>
#include <initializer_list>
#include <utility>

namespace item3d::testing_support {

using GltfJson = nlohmann::ordered_json;

/// Returns an image of one colour.
inline Image plain_image(int size, Vec3 color, int channels = 3) {
    Image image(size, size, channels, 1.0f);
    for (int i = 0; i < size * size; ++i) {
        for (int c = 0; c < 3; ++c)
            image.pixels[static_cast<std::size_t>(i * channels + c)] = color[c];
    }
    return image;
}

/// Returns an image of two pixels side by side.
inline Image two_columns(Vec3 left, Vec3 right) {
    Image image(2, 1, 3);
    for (int c = 0; c < 3; ++c) {
        image.at(0, 0, c) = left[c];
        image.at(1, 0, c) = right[c];
    }
    return image;
}

/// Quad document. Node 0 has mesh 0 with one primitive: corners (-1, -1), (1, -1), (1, 1), (-1, 1)
/// in the plane z = 0, TEXCOORD_0 from (0, 1) to (1, 0), material 0.
class GltfQuad {
  public:
    GltfJson json;

    GltfQuad() {
        json["asset"]["version"] = "2.0";
        json["scene"] = 0;
        json["scenes"] = GltfJson::array({GltfJson{{"nodes", {0}}}});
        json["nodes"] = GltfJson::array({GltfJson{{"mesh", 0}}});
        json["materials"] = GltfJson::array({GltfJson{{"name", "paint"}}});
        json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 0;
        GltfJson primitive;
        primitive["attributes"]["POSITION"] =
            add_floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3");
        primitive["attributes"]["NORMAL"] =
            add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        primitive["attributes"]["TEXCOORD_0"] = add_floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
        primitive["indices"] = add_indices({0, 1, 2, 0, 2, 3});
        primitive["material"] = 0;
        json["meshes"] = GltfJson::array({GltfJson{{"primitives", GltfJson::array({primitive})}}});
    }

    GltfJson& material(std::size_t index = 0) { return json["materials"][index]; }
    GltfJson& primitive() { return json["meshes"][0]["primitives"][0]; }

    std::size_t add_floats(std::initializer_list<float> values, const std::string& type) {
        const std::size_t components = type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
        return add_accessor(values.begin(), values.size() * 4, 5126, values.size() / components,
                            type);
    }
    std::size_t add_indices(std::initializer_list<std::uint16_t> values) {
        return add_accessor(values.begin(), values.size() * 2, 5123, values.size(), "SCALAR");
    }
    /// Adds a texture with its own image. Returns its index.
    std::size_t add_texture(const Image& image) {
        const Bytes png = encode_png(image, 8);
        json["images"].push_back(GltfJson{{"uri", "data:image/png;base64," + encode_base64(png)}});
        json["textures"].push_back(GltfJson{{"source", json["images"].size() - 1}});
        return json["textures"].size() - 1;
    }
    void set_base_color(std::size_t texture) {
        material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = texture;
    }
    void use(const std::string& extension, bool required = false) {
        json["extensionsUsed"].push_back(extension);
        if (required) json["extensionsRequired"].push_back(extension);
    }

    fs::path write(const fs::path& folder, const std::string& name = "quad.gltf") {
        json["buffers"] = GltfJson::array(
            {GltfJson{{"byteLength", binary_.size()},
                      {"uri", "data:application/octet-stream;base64," + encode_base64(binary_)}}});
        const std::string text = json.dump();
        write_quickly(folder / name, Bytes(text.begin(), text.end()));
        return folder / name;
    }

  private:
    std::size_t add_accessor(const void* data, std::size_t size, int component, std::size_t count,
                             const std::string& type) {
        const std::size_t offset = binary_.size();
        binary_.resize(offset + (size + 3) / 4 * 4);
        std::memcpy(binary_.data() + offset, data, size);
        json["bufferViews"].push_back(
            GltfJson{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
        json["accessors"].push_back(GltfJson{{"bufferView", json["bufferViews"].size() - 1},
                                             {"componentType", component},
                                             {"count", count},
                                             {"type", type}});
        return json["accessors"].size() - 1;
    }

    Bytes binary_;
};

}  // namespace item3d::testing_support
