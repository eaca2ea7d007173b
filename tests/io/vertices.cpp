// Tests of glTF vertices that are stored as small integers, or that lack normals.
#include "item3d/io/gltf/read.h"
#include "item3d/io/resources.h"
#include "tests/support/io.h"

#include <cstring>

namespace item3d {
namespace {

using namespace testing_support;
using OrderedJson = nlohmann::ordered_json;

// ------------------------------------------------------------------------ KHR_mesh_quantization

/// A vertex attribute. Each element is padded to a multiple of four bytes.
struct Attribute {
    const char* name;
    const char* type;
    int component_type;
    bool normalized;
    std::vector<std::vector<int>> elements;
};

template <typename T>
void put(Bytes& bytes, int value) {
    const T stored = static_cast<T>(value);
    std::uint8_t raw[sizeof(T)];
    std::memcpy(raw, &stored, sizeof(T));
    bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

Model load_triangle(const std::vector<Attribute>& attributes) {
    OrderedJson json = {{"asset", {{"version", "2.0"}}},
                        {"extensionsRequired", {"KHR_mesh_quantization"}},
                        {"nodes", {{{"mesh", 0}, {"scale", {2, 2, 2}}}}}};
    OrderedJson names;
    Bytes binary;
    for (std::size_t i = 0; i < attributes.size(); ++i) {
        const Attribute& attribute = attributes[i];
        const std::size_t begin = binary.size();
        for (const auto& element : attribute.elements) {
            for (const int value : element) {
                switch (attribute.component_type) {
                    case 5120:
                        put<std::int8_t>(binary, value);
                        break;
                    case 5121:
                        put<std::uint8_t>(binary, value);
                        break;
                    case 5122:
                        put<std::int16_t>(binary, value);
                        break;
                    default:
                        put<std::uint16_t>(binary, value);
                }
            }
            binary.resize((binary.size() + 3) / 4 * 4, 0xee);
        }
        const std::size_t length = binary.size() - begin;
        json["bufferViews"].push_back({{"buffer", 0},
                                       {"byteOffset", begin},
                                       {"byteLength", length},
                                       {"byteStride", length / attribute.elements.size()}});
        json["accessors"].push_back({{"bufferView", i},
                                     {"componentType", attribute.component_type},
                                     {"normalized", attribute.normalized},
                                     {"count", attribute.elements.size()},
                                     {"type", attribute.type}});
        names[attribute.name] = i;
    }
    json["meshes"] = {{{"primitives", {{{"attributes", names}}}}}};
    json["buffers"] = {{{"byteLength", binary.size()},
                        {"uri", "data:application/octet-stream;base64," + encode_base64(binary)}}};
    const std::string text = json.dump();
    return read_gltf("triangle.gltf", Bytes(text.begin(), text.end()));
}

TEST(Quantized, EveryTypeOfEveryAttributeIsRead) {
    struct Type {
        int number;
        float largest;
        bool is_signed;
    };
    for (const Type& type : {Type{5120, 127.0f, true}, Type{5121, 255.0f, false},
                             Type{5122, 32767.0f, true}, Type{5123, 65535.0f, false}}) {
        for (const bool normalized : {false, true}) {
            SCOPED_TRACE(std::to_string(type.number) + (normalized ? " normalized" : ""));
            const int low = type.is_signed ? -100 : 7;
            const std::vector<std::vector<int>> positions = {
                {low, 0, 0}, {120, 1, 0}, {0, static_cast<int>(type.largest), 3}};
            const std::vector<std::vector<int>> uvs = {{low, 0}, {100, 1}, {3, 120}};
            // Normals and tangents must be signed and normalised.
            const int unit = type.number < 5122 ? 127 : 32767;
            const int shape = type.number < 5122 ? 5120 : 5122;
            const Model model = load_triangle(
                {{"POSITION", "VEC3", type.number, normalized, positions},
                 {"NORMAL", "VEC3", shape, true, {{0, 0, unit}, {0, unit, 0}, {0, -unit, unit}}},
                 {"TANGENT",
                  "VEC4",
                  shape,
                  true,
                  {{unit, 0, 0, unit}, {-unit, 0, 0, -unit}, {unit, 0, 0, -unit}}},
                 {"TEXCOORD_0", "VEC2", type.number, normalized, uvs}});
            expect_sound(model);
            const Primitive& primitive = model.primitives[0];
            const float scale = normalized ? 1.0f / type.largest : 1.0f;
            ASSERT_EQ(primitive.positions.size(), 3u);
            for (std::size_t i = 0; i < 3; ++i) {
                for (int c = 0; c < 3; ++c) {
                    const auto raw = static_cast<float>(positions[i][static_cast<std::size_t>(c)]);
                    EXPECT_NEAR(primitive.positions[i][c], 2.0f * scale * raw,
                                1e-6f * std::abs(raw));
                }
                for (int c = 0; c < 2; ++c) {
                    const auto raw = static_cast<float>(uvs[i][static_cast<std::size_t>(c)]);
                    EXPECT_NEAR(primitive.uvs[i][c], scale * raw, 1e-6f * std::abs(raw));
                }
            }
            EXPECT_LT(glm::distance(primitive.normals[1], Vec3(0, 1, 0)), 1e-6f);
            EXPECT_LT(glm::distance(primitive.normals[2], glm::normalize(Vec3(0, -1, 1))), 1e-6f);
            EXPECT_EQ(primitive.tangents[0], Vec4(1, 0, 0, 1));
            EXPECT_EQ(primitive.tangents[1], Vec4(-1, 0, 0, -1));
        }
    }
}

TEST(Quantized, TheLowestSignedValueIsMinusOne) {
    const Model model = load_triangle(
        {{"POSITION", "VEC3", 5120, true, {{-128, -127, 0}, {127, 0, 0}, {0, 127, 0}}}});
    EXPECT_EQ(model.primitives[0].positions[0], Vec3(-2, -2, 0));
}

// --------------------------------------------------------------------------- Without normals

/// Writes a fixture whose meshes lack the given attributes into a folder of its own. Returns its
/// path.
fs::path without(const std::string& name, const std::vector<const char*>& attributes) {
    const fs::path folder = fresh_folder("without");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / name);
    for (auto& mesh : file.json["meshes"]) {
        for (auto& primitive : mesh["primitives"]) {
            for (const char* attribute : attributes)
                primitive["attributes"].erase(attribute);
        }
    }
    file.json["buffers"][0]["uri"] = "data.bin";
    write_atomically(folder / "data.bin", std::span<const std::uint8_t>(file.binary));
    write_atomically(folder / "model.gltf", std::string_view(file.json.dump()));
    return folder / "model.gltf";
}

void expect_flat(const Primitive& primitive) {
    for (std::size_t t = 0; t < primitive.indices.size(); t += 3) {
        const auto at = [&](std::size_t k) {
            return primitive.positions[primitive.indices[t + k]];
        };
        const Vec3 face = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_LT(glm::distance(primitive.normals[primitive.indices[t + k]], face), 1e-5f);
    }
}

// The specification: "client implementations MUST calculate flat normals".
TEST(FlatNormals, AreMadeWhereTheFileHasNone) {
    const Model cube = load_model(data_folder() / "gltf" / "no_indices_no_normals.glb");
    expect_sound(cube);
    expect_flat(cube.primitives[0]);
    // Smooth faces share vertices, and one node mirrors its mesh.
    const Model flat = load_model(without("hierarchy_trs.glb", {"NORMAL"}));
    const Model whole = load_model(data_folder() / "gltf" / "hierarchy_trs.glb");
    expect_sound(flat);
    ASSERT_EQ(flat.primitives.size(), whole.primitives.size());
    for (std::size_t i = 0; i < flat.primitives.size(); ++i) {
        expect_flat(flat.primitives[i]);
        EXPECT_NEAR(signed_volume(flat.primitives[i]), signed_volume(whole.primitives[i]), 1e-4);
        // Nodes that share a mesh have equal vertex numbers.
        EXPECT_EQ(flat.primitives[i].uvs, flat.primitives[0].uvs);
    }
    expect_same_triangles(flat, whole, 1e-6f);
}

TEST(FlatNormals, LeaveTheDocumentsVerticesAsTheyAre) {
    const fs::path path = without("full_pbr.glb", {"NORMAL"});
    const Model model = load_model(path);
    EXPECT_EQ(model.primitives[0].positions.size(), 672u);
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(8, 8, 3);
    edit.primitives[0] = exploded(model.primitives[0]);
    save_model(path.parent_path() / "edited.glb", model, edit);
    const Model back = load_model(path.parent_path() / "edited.glb");
    expect_same_triangles(model, back, 1e-6f, false);
    expect_flat(back.primitives[0]);
    const PrimitiveEdit& wanted = edit.primitives[0];
    for (std::size_t i = 0; i < wanted.indices.size(); ++i) {
        EXPECT_EQ(back.primitives[0].uvs[back.primitives[0].indices[i]],
                  wanted.uvs[wanted.indices[i]]);
    }
}

TEST(FlatNormals, OtherPrimitivesOfTheMaterialKeepTheirCoordinates) {
    const fs::path path = without("hierarchy_trs.glb", {"NORMAL"});
    const Model model = load_model(path);
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(8, 8, 3);
    edit.primitives[1] = exploded(model.primitives[1]);
    save_model(path.parent_path() / "edited.glb", model, edit);
    expect_same_triangles(model, load_model(path.parent_path() / "edited.glb"), 1e-6f, false);
    const Model back = load_model(path.parent_path() / "edited.glb");
    for (const std::size_t i : {0u, 2u})
        EXPECT_EQ(back.primitives[i].uvs, model.primitives[i].uvs);
    EXPECT_NE(back.primitives[1].uvs, model.primitives[1].uvs);
    // If the model has no UVs, it gets zeros for the texture.
    const fs::path bare = without("hierarchy_trs.glb", {"NORMAL", "TEXCOORD_0"});
    const Model bare_model = load_model(bare);
    edit.primitives.clear();
    save_model(bare.parent_path() / "edited.glb", bare_model, edit);
    const Model bare_back = load_model(bare.parent_path() / "edited.glb");
    expect_same_triangles(bare_model, bare_back, 1e-6f, false);
    EXPECT_EQ(bare_back.primitives[0].uvs, std::vector<Vec2>(36, Vec2(0.0f)));
    const OrderedJson json = read_gltf_file(bare.parent_path() / "edited.glb").json;
    const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(json["accessors"][attributes["TEXCOORD_0"].get<std::size_t>()]["count"],
              json["accessors"][attributes["POSITION"].get<std::size_t>()]["count"]);
}

}  // namespace
}  // namespace item3d
