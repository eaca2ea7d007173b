// Helpers for the tests of loaders and writers.
#pragma once

#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "tests/support/reference_folders.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace item3d::testing_support {

namespace fs = std::filesystem;

inline fs::path data_folder() {
    return fs::path(ITEM3D_TEST_DATA) / "scene";
}

/// Returns the path of a textured model that only the whole reference data has. The repository does
/// not have it because it shows a trademark.
inline fs::path logo_box() {
    return reference_data::whole() / "gltf" / "thirdparty" / "BoxTextured" / "BoxTextured.gltf";
}

constexpr const char* draco_extension = "KHR_draco_mesh_compression";
constexpr const char* meshopt_extension = "EXT_meshopt_compression";

inline fs::path fixture(const std::string& name) {
    return data_folder() / "gltf" / name;
}

inline nlohmann::json read_manifest(const fs::path& folder) {
    return nlohmann::json::parse(read_text(folder / "manifest.json"));
}

/// Creates an empty temporary folder and returns its path.
inline fs::path fresh_folder(const std::string& name) {
    const fs::path folder = fs::path(testing::TempDir()) / ("item3d_scene_" + name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

/// Writes a file without the sync to disk of write_atomically().
inline void write_quickly(const fs::path& path, const Bytes& bytes) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

/// Returns an image whose values are multiples of 1/255, which 8-bit files store exactly.
inline Image checkered_image(int width, int height, int channels) {
    Image image(width, height, channels);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = static_cast<float>((i * 37 + i / 7) % 256) / 255.0f;
    }
    return image;
}

inline void expect_same_image(const Image& a, const Image& b, float tolerance = 0.0f) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.channels, b.channels);
    float largest = 0.0f;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const float error = std::abs(a.pixels[i] - b.pixels[i]);
        if (error > largest) {
            largest = error;
            worst = i;
        }
    }
    const auto channels = static_cast<std::size_t>(a.channels);
    const auto width = static_cast<std::size_t>(a.width);
    EXPECT_LE(largest, tolerance) << "at column " << worst / channels % width << ", row "
                                  << worst / channels / width << ", channel " << worst % channels
                                  << ": " << a.pixels[worst] << " instead of " << b.pixels[worst];
}

inline void expect_box(const Model& model, const nlohmann::json& expected) {
    const auto box = model.bounds();
    for (int side = 0; side < 2; ++side) {
        for (int c = 0; c < 3; ++c) {
            const double want = expected[side][c].get<double>();
            const double extent =
                expected[1][c].get<double>() - expected[0][c].get<double>() + std::abs(want);
            EXPECT_NEAR(box[side][c] + model.origin[c], want, 1e-5 * extent + 1e-12)
                << "side " << side << " axis " << c;
        }
    }
}

inline bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Expects the properties that model.h guarantees for every loaded model.
inline void expect_sound(const Model& model) {
    EXPECT_GT(model.triangle_count(), 0u);
    for (const Primitive& primitive : model.primitives) {
        const std::size_t count = primitive.positions.size();
        ASSERT_EQ(primitive.normals.size(), count);
        EXPECT_TRUE(primitive.uvs.empty() || primitive.uvs.size() == count);
        EXPECT_TRUE(primitive.colors.empty() || primitive.colors.size() == count);
        EXPECT_TRUE(primitive.tangents.empty() || primitive.tangents.size() == count);
        for (const Vec3& position : primitive.positions)
            ASSERT_TRUE(is_finite(position));
        for (const Vec3& normal : primitive.normals)
            ASSERT_NEAR(glm::length(normal), 1.0f, 1e-4f);
        ASSERT_EQ(primitive.indices.size() % 3, 0u);
        for (const std::uint32_t index : primitive.indices)
            ASSERT_LT(index, count);
        ASSERT_GE(primitive.material, 0);
        ASSERT_LT(static_cast<std::size_t>(primitive.material), model.materials.size());
    }
    const auto check_texture = [&](int index) {
        ASSERT_LT(index, static_cast<int>(model.textures.size()));
        if (index < 0) return;
        EXPECT_FALSE(model.textures[static_cast<std::size_t>(index)].image.empty());
    };
    for (const Material& material : model.materials) {
        check_texture(material.base_color_texture);
        check_texture(material.metallic_roughness_texture);
        check_texture(material.normal_texture);
        check_texture(material.occlusion_texture);
        check_texture(material.emissive_texture);
    }
}

/// Compares primitives corner by corner, whatever the order of their vertices.
inline void expect_same_triangles(const Model& a, const Model& b, float tolerance = 0.0f,
                                  bool with_uvs = true) {
    ASSERT_EQ(a.primitives.size(), b.primitives.size());
    for (std::size_t i = 0; i < a.primitives.size(); ++i) {
        const Primitive& p = a.primitives[i];
        const Primitive& q = b.primitives[i];
        ASSERT_EQ(p.indices.size(), q.indices.size());
        float position = 0.0f, normal = 0.0f, uv = 0.0f;
        ASSERT_TRUE(!with_uvs || p.uvs.empty() == q.uvs.empty());
        for (std::size_t k = 0; k < p.indices.size(); ++k) {
            const std::uint32_t u = p.indices[k];
            const std::uint32_t v = q.indices[k];
            position = std::max(position, glm::distance(p.positions[u], q.positions[v]));
            normal = std::max(normal, glm::distance(p.normals[u], q.normals[v]));
            if (with_uvs && !p.uvs.empty()) uv = std::max(uv, glm::distance(p.uvs[u], q.uvs[v]));
        }
        const auto box = a.bounds();
        const float size = std::max(glm::length(box[0]), glm::length(box[1]));
        EXPECT_LE(position, tolerance * size);
        EXPECT_LE(normal, std::max(10 * tolerance, 1e-6f));
        EXPECT_LE(uv, tolerance);
    }
}

/// Returns the signed volume of a closed mesh, which is positive if the triangles face outwards.
inline double signed_volume(const Primitive& primitive) {
    double sum = 0.0;
    for (std::size_t t = 0; t < primitive.indices.size(); t += 3) {
        const auto at = [&](std::size_t k) {
            return glm::dvec3(primitive.positions[primitive.indices[t + k]]) -
                   glm::dvec3(primitive.positions[0]);
        };
        sum += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
    }
    return sum;
}

/// Returns an edit that gives each triangle its own vertices and its own cell of the UV square.
inline PrimitiveEdit exploded(const Primitive& primitive) {
    PrimitiveEdit edit;
    const std::size_t triangles = primitive.indices.size() / 3;
    const auto columns =
        static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(triangles))));
    const float cell = 1.0f / static_cast<float>(columns);
    for (std::size_t t = 0; t < triangles; ++t) {
        const Vec2 origin(static_cast<float>(t % columns) * cell,
                          static_cast<float>(t / columns) * cell);
        const Vec2 corners[] = {{0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}};
        for (std::size_t k = 0; k < 3; ++k) {
            edit.source_vertices.push_back(primitive.indices[3 * t + k]);
            edit.uvs.push_back(origin + corners[k] * cell);
            edit.indices.push_back(static_cast<std::uint32_t>(3 * t + k));
        }
    }
    return edit;
}

/// JSON and BIN chunks of a .glb, or the JSON of a .gltf.
struct GltfFile {
    nlohmann::ordered_json json;
    Bytes binary;
};
inline GltfFile read_gltf_file(const fs::path& path) {
    const Bytes bytes = read_bytes(path);
    GltfFile file;
    if (path.extension() == ".gltf") {
        file.json = nlohmann::ordered_json::parse(bytes.begin(), bytes.end());
        return file;
    }
    const auto number = [&](std::size_t at) {
        return static_cast<std::size_t>(bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16) +
               (static_cast<std::size_t>(bytes[at + 3]) << 24);
    };
    const std::size_t json_length = number(12);
    const auto at = [&](std::size_t offset) {
        return bytes.begin() + static_cast<std::ptrdiff_t>(offset);
    };
    file.json = nlohmann::ordered_json::parse(at(20), at(20 + json_length));
    if (bytes.size() > 28 + json_length) {
        file.binary.assign(at(28 + json_length), at(28 + json_length + number(20 + json_length)));
    }
    return file;
}

/// Returns the raw bytes of a buffer view of a .glb.
inline Bytes view_bytes(const GltfFile& file, std::size_t index) {
    const nlohmann::ordered_json& plain = file.json["bufferViews"].at(index);
    const bool is_compressed =
        plain.contains("extensions") && plain["extensions"].contains(meshopt_extension);
    const nlohmann::ordered_json& view =
        is_compressed ? plain["extensions"][meshopt_extension] : plain;
    const auto begin = file.binary.begin() + view.value("byteOffset", std::ptrdiff_t{0});
    return Bytes(begin, begin + view["byteLength"].get<std::ptrdiff_t>());
}

/// Expects that an edit replaced images only, which may give images and buffer views new indices.
inline void expect_nothing_else_changed(const GltfFile& before, const GltfFile& after) {
    for (const auto& [key, value] : before.json.items()) {
        if (key == "materials" || key == "meshes" || key == "buffers" || key == "textures" ||
            key == "images" || key == "bufferViews")
            continue;
        if (key == "asset") {
            EXPECT_EQ(value["version"], after.json[key]["version"]);
            continue;
        }
        if (key == "extensionsUsed") {
            // Edited materials are not unlit, so this extension may become unused and be dropped.
            const auto names = after.json.value(key, std::vector<std::string>());
            for (const auto& name : value)
                EXPECT_TRUE(name == "KHR_materials_unlit" ||
                            std::find(names.begin(), names.end(), name) != names.end())
                    << name;
            continue;
        }
        if (!value.is_array()) {
            EXPECT_EQ(value, after.json[key]) << key;
            continue;
        }
        // Lists may only grow at the end.
        for (std::size_t i = 0; i < value.size(); ++i) {
            nlohmann::ordered_json old = value[i];
            nlohmann::ordered_json now = after.json[key][i];
            if (key == "accessors" && old.contains("bufferView")) {
                EXPECT_EQ(view_bytes(before, old["bufferView"]),
                          view_bytes(after, now["bufferView"]));
                now["bufferView"] = old["bufferView"];
            }
            if (key == "accessors" && old.contains("sparse")) {
                for (const char* part : {"indices", "values"}) {
                    EXPECT_EQ(view_bytes(before, old["sparse"][part]["bufferView"]),
                              view_bytes(after, now["sparse"][part]["bufferView"]));
                    now["sparse"][part]["bufferView"] = old["sparse"][part]["bufferView"];
                }
            }
            EXPECT_EQ(old, now) << key;
        }
    }
}

}  // namespace item3d::testing_support
