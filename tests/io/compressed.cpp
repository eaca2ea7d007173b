// Tests of Draco and meshopt: their decoding, and edits of compressed files.
#include "item3d/io/gltf/meshopt.h"
#include "tests/support/io.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

namespace item3d {
namespace {

using namespace testing_support;
using OrderedJson = nlohmann::ordered_json;

// Checks that each triangle of one model is a triangle of the other, up to quantization. Encoders
// change the order of vertices and triangles.
void expect_same_surface(const Model& model, const Model& original, float tolerance) {
    ASSERT_EQ(model.primitives.size(), original.primitives.size());
    for (std::size_t i = 0; i < model.primitives.size(); ++i) {
        const Primitive &p = model.primitives[i], &q = original.primitives[i];
        ASSERT_EQ(p.indices.size(), q.indices.size());
        ASSERT_EQ(p.uvs.empty(), q.uvs.empty());
        ASSERT_EQ(p.colors.empty(), q.colors.empty());
        const auto is_near = [&](std::uint32_t a, std::uint32_t b) {
            return glm::distance(p.positions[a], q.positions[b]) <= tolerance &&
                   glm::distance(p.normals[a], q.normals[b]) <= 10 * tolerance &&
                   (p.uvs.empty() || glm::distance(p.uvs[a], q.uvs[b]) <= tolerance) &&
                   (p.colors.empty() || glm::distance(p.colors[a], q.colors[b]) <= tolerance);
        };
        std::size_t lost = 0;
        for (std::size_t t = 0; t < p.indices.size(); t += 3) {
            bool found = false;
            for (std::size_t u = 0; u < q.indices.size() && !found; u += 3) {
                for (std::size_t turn = 0; turn < 3 && !found; ++turn) {
                    found = true;
                    for (std::size_t k = 0; k < 3 && found; ++k)
                        found = is_near(p.indices[t + k], q.indices[u + (k + turn) % 3]);
                }
            }
            lost += found ? 0 : 1;
        }
        EXPECT_EQ(lost, 0u) << "of " << p.indices.size() / 3 << " triangles";
    }
}

TEST(Compressed, ModelsAreTheirOriginals) {
    const std::vector<std::array<const char*, 2>> pairs = {
        {"draco_edgebreaker.glb", "full_pbr.glb"},
        {"draco_sequential.glb", "vertex_colors_u8.glb"},
        {"meshopt_filters.glb", "full_pbr.glb"},
        {"meshopt_morph_skin.glb", "morph_skin.glb"}};
    for (const auto& [name, original] : pairs) {
        SCOPED_TRACE(name);
        const Model model = load_model(fixture(name));
        expect_sound(model);
        expect_same_surface(model, load_model(fixture(original)), 2e-3f);
        EXPECT_EQ(model.textures.size(), load_model(fixture(original)).textures.size());
    }
}

TEST(Compressed, ThirdPartyModelsAreTheirOriginals) {
    const fs::path folder = reference_data::crops() / "gltf" / "thirdparty";
    const Model box = load_model(folder / "Box.glb");
    expect_same_surface(load_model(folder / "BoxDraco" / "BoxDraco.gltf"), box, 1e-3f);
    expect_same_surface(load_model(folder / "BoxMeshopt.glb"), box, 1e-3f);
}

// ------------------------------------------------------------------------------------- Edits

bool lists(const OrderedJson& json, const char* key, const char* extension) {
    if (!json.contains(key)) return false;
    return std::find(json[key].begin(), json[key].end(), extension) != json[key].end();
}
ModelEdit red_edit() {
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(8, 8, 3);
    return edit;
}

TEST(Compressed, GeometryStaysCompressedUnderNewTextures) {
    const fs::path folder = fresh_folder("stays");
    for (const char* name : {"draco_edgebreaker.glb", "meshopt_filters.glb"}) {
        for (const char* extension : {".glb", ".gltf"}) {
            SCOPED_TRACE(std::string(name) + " as " + extension);
            const Model model = load_model(fixture(name));
            const fs::path path = folder / (fixture(name).stem().string() + extension);
            save_model(path, model, red_edit());
            OrderedJson before = read_gltf_file(fixture(name)).json;
            OrderedJson after = read_gltf_file(path).json;
            // The views of removed images are gone, so the indices of buffer views may differ.
            for (OrderedJson* json : {&before, &after}) {
                OrderedJson& primitive = (*json)["meshes"][0]["primitives"][0];
                if (primitive.contains("extensions"))
                    primitive["extensions"][draco_extension].erase("bufferView");
            }
            EXPECT_EQ(after["meshes"], before["meshes"]);
            EXPECT_EQ(after["extensionsUsed"], before["extensionsUsed"]);
            EXPECT_EQ(after["extensionsRequired"], before["extensionsRequired"]);
            const Model back = load_model(path);
            expect_same_triangles(model, back);
            expect_same_image(
                back.textures[static_cast<std::size_t>(back.materials[0].base_color_texture)].image,
                checkered_image(8, 8, 3), 1e-6f);
        }
    }
}

TEST(Compressed, NewUvsMakePlainGeometry) {
    const fs::path folder = fresh_folder("plain");
    for (const char* name : {"draco_edgebreaker.glb", "draco_sequential.glb", "meshopt_filters.glb",
                             "meshopt_morph_skin.glb"}) {
        SCOPED_TRACE(name);
        const Model model = load_model(fixture(name));
        ModelEdit edit = red_edit();
        edit.primitives[0] = exploded(model.primitives[0]);
        save_model(folder / name, model, edit);
        const OrderedJson json = read_gltf_file(folder / name).json;
        EXPECT_FALSE(json["meshes"][0]["primitives"][0].contains("extensions"));
        EXPECT_FALSE(lists(json, "extensionsUsed", draco_extension));
        EXPECT_FALSE(lists(json, "extensionsRequired", draco_extension));
        // The old buffer views are still in the file, and those of meshopt are still compressed.
        EXPECT_EQ(lists(json, "extensionsRequired", meshopt_extension),
                  std::string(name).starts_with("meshopt"));
        const Model back = load_model(folder / name);
        expect_sound(back);
        expect_same_triangles(model, back, 1e-6f, false);
        const PrimitiveEdit& wanted = edit.primitives[0];
        ASSERT_EQ(back.primitives[0].uvs.size(), wanted.uvs.size());
        for (std::size_t i = 0; i < wanted.uvs.size(); ++i)
            EXPECT_EQ(back.primitives[0].uvs[i], wanted.uvs[i]);
    }
}

// Writes the fixture with its mesh twice. The second mesh has its own node and its own accessors to
// the same data.
fs::path two_draco_meshes(const fs::path& folder, int second_material) {
    GltfFile file = read_gltf_file(fixture("draco_sequential.glb"));
    OrderedJson& json = file.json;
    OrderedJson mesh = json["meshes"][0];
    OrderedJson& primitive = mesh["primitives"][0];
    const std::size_t count = json["accessors"].size();
    for (std::size_t i = 0; i < count; ++i) {
        const OrderedJson copy = json["accessors"][i];
        json["accessors"].push_back(copy);
    }
    primitive["indices"] = primitive["indices"].get<std::size_t>() + count;
    for (auto& [name, accessor] : primitive["attributes"].items())
        accessor = accessor.get<std::size_t>() + count;
    primitive["material"] = second_material;
    const OrderedJson material = json["materials"][0];
    json["materials"].push_back(material);
    json["meshes"].push_back(mesh);
    json["nodes"].push_back({{"mesh", 1}});
    json["scenes"][0]["nodes"].push_back(1);
    json["buffers"][0]["uri"] = "two.bin";
    write_atomically(folder / "two.bin", std::span<const std::uint8_t>(file.binary));
    write_atomically(folder / "two.gltf", std::string_view(json.dump()));
    return folder / "two.gltf";
}

TEST(Compressed, OtherPrimitivesStayCompressed) {
    const fs::path folder = fresh_folder("other");
    const Model model = load_model(two_draco_meshes(folder, 1));
    ModelEdit edit = red_edit();
    edit.primitives[0] = exploded(model.primitives[0]);
    save_model(folder / "edited.glb", model, edit);
    const OrderedJson json = read_gltf_file(folder / "edited.glb").json;
    EXPECT_FALSE(json["meshes"][0]["primitives"][0].contains("extensions"));
    EXPECT_TRUE(json["meshes"][1]["primitives"][0]["extensions"].contains(draco_extension));
    EXPECT_TRUE(lists(json, "extensionsUsed", draco_extension));
    EXPECT_TRUE(lists(json, "extensionsRequired", draco_extension));
    expect_same_triangles(model, load_model(folder / "edited.glb"), 1e-6f, false);
}

// The primitive and its extension both name attributes. Those of the extension have priority.
TEST(Compressed, RenamedAndDroppedAttributesAreSoInTheExtension) {
    const fs::path folder = fresh_folder("renamed");
    const Model model = load_model(two_draco_meshes(folder, 0));
    ASSERT_FALSE(model.primitives[1].colors.empty());
    ModelEdit edit = red_edit();
    edit.primitives[0] = exploded(model.primitives[0]);
    save_model(folder / "edited.glb", model, edit);
    const OrderedJson json = read_gltf_file(folder / "edited.glb").json;
    // The second primitive keeps its coordinates under both names. It loses its colours, which are
    // now in the texture.
    const OrderedJson& primitive = json["meshes"][1]["primitives"][0];
    EXPECT_FALSE(primitive["attributes"].contains("COLOR_0"));
    EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_1"));
    EXPECT_EQ(primitive["extensions"][draco_extension]["attributes"],
              OrderedJson({{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_1", 2}}));
    const Model back = load_model(folder / "edited.glb");
    expect_same_triangles(model, back, 1e-6f, false);
    EXPECT_TRUE(back.primitives[1].colors.empty());
    EXPECT_EQ(back.primitives[1].uvs, model.primitives[1].uvs);
    EXPECT_EQ(back.primitives[0].uvs, edit.primitives[0].uvs);
}

// -------------------------------------------------------------------------- Modes and filters

/// A document with one buffer view of `count` elements, whose data are `encoded`.
struct View {
    Bytes encoded;
    const char* mode;
    const char* filter;
    std::size_t stride, count;

    Bytes decode() const {
        SourceDocument document;
        document.path = "view.gltf";
        document.buffers = {encoded, {}};
        document.json = {{"bufferViews",
                          {{{"buffer", 1},
                            {"byteLength", stride * count},
                            {"extensions",
                             {{meshopt_extension,
                               {{"buffer", 0},
                                {"byteLength", encoded.size()},
                                {"byteStride", stride},
                                {"count", count},
                                {"mode", mode},
                                {"filter", filter}}}}}}}}};
        decode_meshopt_views(document);
        const auto bytes = buffer_view_bytes(document, 0);
        return Bytes(bytes.begin(), bytes.end());
    }
};

Bytes encode_vertices(const void* data, std::size_t count, std::size_t stride) {
    Bytes encoded(meshopt_encodeVertexBufferBound(count, stride));
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), data, count, stride));
    return encoded;
}

template <typename T>
std::vector<T> values_of(const Bytes& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

/// Returns the triangles, each starting at its smallest index, because encoders may choose any
/// corner.
std::vector<std::uint32_t> turned(std::vector<std::uint32_t> indices) {
    for (auto at = indices.begin(); at != indices.end(); at += 3)
        std::rotate(at, std::min_element(at, at + 3), at + 3);
    return indices;
}

Bytes encode_triangles(const std::vector<std::uint32_t>& indices) {
    Bytes encoded(meshopt_encodeIndexBufferBound(indices.size(), indices.size()));
    encoded.resize(
        meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), indices.data(), indices.size()));
    return encoded;
}

TEST(Meshopt, IndicesOfBothModesAndSizesComeBack) {
    std::vector<std::uint32_t> strip, triangles;
    for (std::uint32_t i = 0; i < 300; ++i) {
        strip.push_back(i * 7 % 300);
        triangles.insert(triangles.end(), {i, i + 1, i + 2});
    }
    const auto indices = [](const Bytes& bytes, std::size_t stride) {
        if (stride == 4) return values_of<std::uint32_t>(bytes);
        const auto values = values_of<std::uint16_t>(bytes);
        return std::vector<std::uint32_t>(values.begin(), values.end());
    };
    Bytes sequence(meshopt_encodeIndexSequenceBound(strip.size(), 300));
    sequence.resize(
        meshopt_encodeIndexSequence(sequence.data(), sequence.size(), strip.data(), strip.size()));
    const Bytes buffer = encode_triangles(triangles);
    for (const std::size_t stride : {2u, 4u}) {
        const View strips{sequence, "INDICES", "NONE", stride, strip.size()};
        EXPECT_EQ(indices(strips.decode(), stride), strip);
        const View lists{buffer, "TRIANGLES", "NONE", stride, triangles.size()};
        EXPECT_EQ(turned(indices(lists.decode(), stride)), triangles);
    }
}

TEST(Meshopt, FiltersAreUndone) {
    // The number of elements is odd, so that no filter may assume groups of four.
    constexpr std::size_t count = 37;
    std::vector<float> vectors, quaternions, numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const float a = 0.37f * static_cast<float>(i), b = 1.1f * static_cast<float>(i);
        const Vec3 v(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
        vectors.insert(vectors.end(), {v.x, v.y, v.z, 0.0f});
        const Vec4 q(v * std::sin(0.2f * a), std::cos(0.2f * a));
        quaternions.insert(quaternions.end(), {q.x, q.y, q.z, q.w});
        numbers.insert(numbers.end(), {1e4f * v.x, 1e-3f * v.y, -v.z});
    }
    const auto expect = [](const char* what, const std::vector<float>& found,
                           const std::vector<float>& wanted, float tolerance) {
        SCOPED_TRACE(what);
        ASSERT_EQ(found.size(), wanted.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_NEAR(found[i], wanted[i], tolerance) << i;
    };
    const auto scaled = [](const auto& integers, float largest) {
        std::vector<float> values;
        for (const auto value : integers)
            values.push_back(static_cast<float>(value) / largest);
        return values;
    };
    for (const std::size_t stride : {4u, 8u}) {
        Bytes filtered(count * stride);
        meshopt_encodeFilterOct(filtered.data(), count, stride, 8, vectors.data());
        const Bytes bytes = View{encode_vertices(filtered.data(), count, stride), "ATTRIBUTES",
                                 "OCTAHEDRAL", stride, count}
                                .decode();
        expect("octahedral",
               stride == 4 ? scaled(values_of<std::int8_t>(bytes), 127.0f)
                           : scaled(values_of<std::int16_t>(bytes), 32767.0f),
               vectors, 0.02f);
    }
    Bytes filtered(count * 8);
    meshopt_encodeFilterQuat(filtered.data(), count, 8, 14, quaternions.data());
    std::vector<float> found =
        scaled(values_of<std::int16_t>(View{encode_vertices(filtered.data(), count, 8),
                                            "ATTRIBUTES", "QUATERNION", 8, count}
                                           .decode()),
               32767.0f);
    for (std::size_t i = 0; i < found.size(); i += 4) {
        float dot = 0.0f;  // a quaternion and its opposite are the same rotation
        for (std::size_t c = 0; c < 4; ++c)
            dot += found[i + c] * quaternions[i + c];
        for (std::size_t c = 0; c < 4; ++c)
            found[i + c] *= dot < 0.0f ? -1.0f : 1.0f;
    }
    expect("quaternion", found, quaternions, 1e-3f);
    filtered.resize(count * 12);
    meshopt_encodeFilterExp(filtered.data(), count, 12, 24, numbers.data());
    found = values_of<float>(
        View{encode_vertices(filtered.data(), count, 12), "ATTRIBUTES", "EXPONENTIAL", 12, count}
            .decode());
    expect("exponential", found, numbers, 2e-3f);  // 24 bits of the largest of three
    const Bytes plain =
        View{encode_vertices(numbers.data(), count, 12), "ATTRIBUTES", "NONE", 12, count}.decode();
    EXPECT_EQ(values_of<float>(plain), numbers);
}

// The formats pack zeros so tightly that the bound on the size of the data must be exact.
TEST(Meshopt, TheDensestDataIsAccepted) {
    for (const std::size_t stride : {4u, 16u, 32u, 64u, 256u}) {
        const std::vector<std::uint8_t> zeros(100000 * stride, 0);
        const Bytes encoded = encode_vertices(zeros.data(), 100000, stride);
        EXPECT_EQ((View{encoded, "ATTRIBUTES", "NONE", stride, 100000}.decode()), zeros);
    }
    std::vector<std::uint32_t> strip;
    for (std::uint32_t i = 0; i < 30000; ++i)
        strip.insert(strip.end(), {i, i + 1, i + 2});
    const View view{encode_triangles(strip), "TRIANGLES", "NONE", 4, strip.size()};
    EXPECT_EQ(turned(values_of<std::uint32_t>(view.decode())), strip);
}

}  // namespace
}  // namespace item3d
