// Tests of glTF files with flaws that other readers tolerate.
#include "item3d/core/error.h"
#include "tests/support/io.h"

#include <cstring>
#include <limits>

namespace item3d {
namespace {

using namespace testing_support;

void put_number(Bytes& bytes, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(value >> shift & 255));
}

// Returns a .glb with `spaces` spaces after the JSON. The chunk is padded only if `pads` is true.
Bytes container(const GltfFile& file, std::size_t spaces, bool pads) {
    std::string text = file.json.dump();
    text.resize((text.size() + 3) / 4 * 4 + spaces, ' ');
    Bytes bytes;
    for (const char c : std::string("glTF"))
        bytes.push_back(static_cast<std::uint8_t>(c));
    put_number(bytes, 2);
    put_number(bytes, 0);
    put_number(bytes, text.size());
    put_number(bytes, 0x4e4f534a);
    bytes.insert(bytes.end(), text.begin(), text.end());
    if (pads) bytes.resize((bytes.size() + 3) / 4 * 4, 0);
    put_number(bytes, file.binary.size());
    put_number(bytes, 0x004e4942);
    bytes.insert(bytes.end(), file.binary.begin(), file.binary.end());
    for (int i = 0; i < 4; ++i)
        bytes[8 + static_cast<std::size_t>(i)] =
            static_cast<std::uint8_t>(bytes.size() >> (8 * i) & 255);
    return bytes;
}

TEST(GltfFlaws, UnpaddedChunksAreRead) {
    const fs::path folder = fresh_folder("unpadded");
    const fs::path whole = data_folder() / "gltf" / "full_pbr.glb";
    const GltfFile file = read_gltf_file(whole);
    const Model expected = load_model(whole);
    for (const std::size_t spaces : {0u, 1u, 2u, 3u}) {
        for (const bool pads : {true, false}) {
            write_quickly(folder / "a.glb", container(file, spaces, pads));
            const Model model = load_model(folder / "a.glb");
            expect_same_triangles(model, expected);
            EXPECT_EQ(model.textures.size(), expected.textures.size());
            // The output follows the specification.
            save_model(folder / "b.glb", model);
            EXPECT_EQ(read_bytes(folder / "b.glb").size() % 4, 0u);
            expect_same_triangles(load_model(folder / "b.glb"), expected);
        }
    }
}

TEST(GltfFlaws, TextureCoordinatesThatAreNoNumbersAreSaid) {
    const fs::path folder = fresh_folder("nan_uvs");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    const auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    const auto& accessor = file.json["accessors"][attributes["TEXCOORD_0"].get<std::size_t>()];
    const auto& view = file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    ASSERT_EQ(accessor["componentType"], 5126);
    const std::size_t offset = view.value("byteOffset", 0u) + accessor.value("byteOffset", 0u);
    const float wrong[] = {std::numeric_limits<float>::quiet_NaN(), 0.5f, 0.5f,
                           std::numeric_limits<float>::infinity()};
    std::memcpy(&file.binary[offset], wrong, sizeof wrong);
    write_quickly(folder / "a.glb", container(file, 0, true));
    testing::internal::CaptureStderr();
    const Model model = load_model(folder / "a.glb");
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("2 of "), std::string::npos) << said;
    EXPECT_NE(said.find("are not finite numbers"), std::string::npos) << said;
    for (const Vec2& uv : model.primitives[0].uvs)
        EXPECT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y));
}

TEST(GltfFlaws, ACopyHasNoAttributesThatAreNotFinite) {
    const fs::path folder = fresh_folder("nan_attributes");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    auto& accessors = file.json["accessors"];
    const auto attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    const auto offset_of = [&](const nlohmann::ordered_json& index, std::size_t element) {
        const auto& accessor = accessors[index.get<std::size_t>()];
        const auto& view = file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
        const std::size_t width = accessor["type"] == "VEC4"   ? 16
                                  : accessor["type"] == "VEC3" ? 12
                                                               : 8;
        return view.value("byteOffset", 0u) + accessor.value("byteOffset", 0u) + element * width;
    };
    const float wrong = -std::numeric_limits<float>::infinity();
    for (const auto& [name, index] : attributes.items())
        if (name != "POSITION" && accessors[index.get<std::size_t>()]["componentType"] == 5126)
            std::memcpy(&file.binary[offset_of(index, 1) + 4], &wrong, sizeof wrong);
    write_quickly(folder / "a.glb", container(file, 0, true));
    for (const char* name : {"b.glb", "b.gltf"}) {
        save_model(folder / name, load_model(folder / "a.glb"));
        save_model(folder / "c.glb", load_model(folder / name));
        const GltfFile copy = read_gltf_file(folder / "c.glb");
        for (const auto& [attribute, index] : attributes.items()) {
            if (attribute == "POSITION") continue;
            float values[2];
            std::memcpy(values, &copy.binary[offset_of(index, 1)], sizeof values);
            EXPECT_EQ(values[0], 0) << name << ' ' << attribute;
            EXPECT_EQ(values[1], 0) << name << ' ' << attribute;
        }
    }
}

TEST(GltfFlaws, AModelOfWhichNothingIsSeenIsSaid) {
    const fs::path folder = fresh_folder("unseen");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    const auto said_of = [&] {
        write_quickly(folder / "a.glb", container(file, 0, true));
        testing::internal::CaptureStderr();
        load_model(folder / "a.glb");
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(said_of().find("the model is invisible"), std::string::npos);
    auto& material = file.json["materials"][0];
    material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0};
    EXPECT_EQ(said_of().find("the model is invisible"), std::string::npos);  // opaque
    for (const char* mode : {"BLEND", "MASK"}) {
        material["alphaMode"] = mode;
        EXPECT_NE(said_of().find("the model is invisible"), std::string::npos) << mode;
    }
    material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.4};
    EXPECT_NE(said_of().find("the model is invisible"), std::string::npos);  // below the cutoff
    material["alphaMode"] = "BLEND";
    EXPECT_EQ(said_of().find("the model is invisible"), std::string::npos);
    for (auto& node : file.json["nodes"]) {
        node.erase("matrix");
        node["scale"] = {0, 0, 1};
    }
    EXPECT_NE(said_of().find("the model is invisible"), std::string::npos);
}

TEST(GltfFlaws, ImagesElsewhereAreReadFromFoldersThatAreAllowed) {
    const fs::path folder = fresh_folder("allowed_pictures");
    fs::create_directories(folder / "model");
    fs::create_directories(folder / "shared");
    save_image(folder / "shared" / "t.png", checkered_image(4, 4, 3));
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    for (auto& image : file.json["images"])
        image = {{"uri", "../shared/t.png"}};
    write_quickly(folder / "model" / "a.glb", container(file, 0, true));
    EXPECT_TRUE(load_model(folder / "model" / "a.glb").textures.empty());
    const Model model =
        load_model(folder / "model" / "a.glb", {.texture_folders = {folder / "shared"}});
    EXPECT_FALSE(model.textures.empty());
    // A .glb that is written contains the images.
    save_model(folder / "b.glb", model);
    EXPECT_EQ(load_model(folder / "b.glb").textures.size(), model.textures.size());
}

TEST(GltfFlaws, TheMissingImageOfTheBaseColorIsNamed) {
    const fs::path folder = fresh_folder("missing_picture");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    const auto texture =
        file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"]
            .get<std::size_t>();
    const auto image = file.json["textures"][texture]["source"].get<std::size_t>();
    EXPECT_EQ(load_model(data_folder() / "gltf" / "full_pbr.glb").materials[0].missing_base_color,
              "");
    file.json["images"][image] = {{"uri", "gone.png"}};
    write_quickly(folder / "a.glb", container(file, 0, true));
    EXPECT_EQ(load_model(folder / "a.glb").materials[0].missing_base_color, "gone.png");
}

TEST(GltfFlaws, AModelIsNeitherTooSmallNorTooLarge) {
    const fs::path file = fresh_folder("sizes") / "a.glb";
    GltfFile quad = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    const auto refusal_of = [&](double scale) -> std::string {
        for (auto& node : quad.json["nodes"]) {
            node.erase("matrix");
            node["scale"] = {scale, scale, scale};
        }
        write_quickly(file, container(quad, 0, true));
        try {
            load_model(file);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    for (const double scale : {1e-6, 1e6, 1e14})
        EXPECT_EQ(refusal_of(scale), "") << scale;
    for (const double scale : {1e-9, 1e-20, 1e16, 1e30})
        EXPECT_NE(refusal_of(scale).find("units across"), std::string::npos)
            << scale << ": " << refusal_of(scale);
}

TEST(GltfFlaws, ADamagedTextureOfTheBaseColorLeavesItsFactor) {
    const fs::path folder = fresh_folder("damaged_texture");
    GltfFile file = read_gltf_file(data_folder() / "gltf" / "full_pbr.glb");
    auto& pbr = file.json["materials"][0]["pbrMetallicRoughness"];
    pbr["baseColorFactor"] = {0.25, 0.5, 0.75, 1};
    for (const nlohmann::json& index :
         {nlohmann::json(1000), nlohmann::json(-1), nlohmann::json("0"), nlohmann::json(nullptr)}) {
        pbr["baseColorTexture"] = {{"index", index}};
        write_quickly(folder / "a.glb", container(file, 0, true));
        testing::internal::CaptureStderr();
        const Model model = load_model(folder / "a.glb");
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_NE(said.find("baseColorTexture"), std::string::npos) << index << ": " << said;
        EXPECT_EQ(model.materials[0].base_color_texture, -1) << index;
        EXPECT_EQ(model.materials[0].base_color_factor, Vec4(0.25f, 0.5f, 0.75f, 1)) << index;
    }
}

}  // namespace
}  // namespace item3d
