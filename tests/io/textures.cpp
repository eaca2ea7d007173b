// Tests of the images of textures, and of their replacements by edits.
#include "item3d/core/error.h"
#include "item3d/io/file_names.h"
#include "item3d/io/texture_format.h"
#include "tests/support/textured.h"

#include <algorithm>

namespace item3d {
namespace {

using namespace testing_support;

constexpr ImageCoding lossless_webp{ImageEncoding::webp, true, 95};

Bytes ktx2_file(const std::string& name) {
    return read_bytes(data_folder() / "images" / (name + ".ktx2"));
}

OrderedJson extension_texture(const char* name, int image) {
    OrderedJson texture = OrderedJson::object();
    texture["extensions"][name]["source"] = image;
    return texture;
}

/// Returns an edit that replaces the base colour of the first `count` materials.
ModelEdit base_color_edit(const Model& model, int count,
                          TextureFormat format = TextureFormat::keep) {
    ModelEdit edit;
    for (int i = 0; i < count; ++i)
        edit.materials[i].base_color = test_image(3, 40 + i, 30);
    choose_codings(model, format, edit);
    return edit;
}

/// Saves the model as a .glb with its images, and returns the loaded result.
Model packed(const fs::path& path) {
    const fs::path glb = path.parent_path() / (path.stem().string() + "_packed.glb");
    save_model(glb, load_model(path));
    return load_model(glb);
}

bool is_listed(const OrderedJson& json, const char* list, const std::string& name) {
    return json.contains(list) &&
           std::find(json[list].begin(), json[list].end(), name) != json[list].end();
}

Bytes image_bytes(const GltfFile& file, std::size_t image) {
    return view_bytes(file, file.json["images"].at(image)["bufferView"]);
}

TEST(Textures, OfWebpAreReadAndStayWebp) {
    const fs::path folder = fresh_folder("texture_webp");
    const Bytes webp = encode_texture(test_image(3), lossless_webp, 8);
    write_textured(
        folder / "a.gltf", {{"a.webp", webp}},
        OrderedJson::array({extension_texture("EXT_texture_webp", 0)}), textured_materials(1),
        {{"extensionsUsed", {"EXT_texture_webp"}}, {"extensionsRequired", {"EXT_texture_webp"}}});
    const Model model = packed(folder / "a.gltf");
    expect_same_image(base_color_of(model, 0).image, test_image(3), 1e-6f);
    save_model(folder / "b.glb", model, base_color_edit(model, 1));
    const GltfFile file = read_gltf_file(folder / "b.glb");
    EXPECT_TRUE(is_listed(file.json, "extensionsUsed", "EXT_texture_webp"));
    EXPECT_TRUE(is_listed(file.json, "extensionsRequired", "EXT_texture_webp"));
    ASSERT_EQ(file.json["images"].size(), 1u);
    EXPECT_EQ(file.json["images"][0]["mimeType"], "image/webp");
    EXPECT_FALSE(file.json["textures"][0].contains("source"));
    expect_same_image(base_color_of(load_model(folder / "b.glb"), 0).image, test_image(3, 40, 30),
                      1e-6f);
    // With PNG, nothing requires the extension any more.
    save_model(folder / "c.glb", model, base_color_edit(model, 1, TextureFormat::png));
    const OrderedJson json = read_gltf_file(folder / "c.glb").json;
    EXPECT_FALSE(json.contains("extensionsUsed"));
    EXPECT_FALSE(json.contains("extensionsRequired"));
}

TEST(Textures, OfKtx2BecomeWhatEveryViewerReads) {
    const fs::path folder = fresh_folder("texture_ktx2");
    write_textured(
        folder / "a.gltf", {{"a.ktx2", ktx2_file("etc1s")}, {"b.ktx2", ktx2_file("uastc_zstd")}},
        {extension_texture("KHR_texture_basisu", 0), extension_texture("KHR_texture_basisu", 1)},
        textured_materials(2),
        {{"extensionsUsed", {"KHR_texture_basisu"}},
         {"extensionsRequired", {"KHR_texture_basisu"}}});
    const Model model = packed(folder / "a.gltf");
    EXPECT_EQ(base_color_of(model, 1).image.channels, 4);
    save_model(folder / "one.glb", model, base_color_edit(model, 1));
    const GltfFile one = read_gltf_file(folder / "one.glb");
    EXPECT_TRUE(is_listed(one.json, "extensionsRequired", "KHR_texture_basisu"));
    ASSERT_EQ(one.json["images"].size(), 2u);
    // The texture that was not edited has the same bytes as before. The edited one was removed.
    EXPECT_TRUE(contains(one.binary, ktx2_file("uastc_zstd")));
    EXPECT_FALSE(contains(one.binary, ktx2_file("etc1s")));
    const Model back = load_model(folder / "one.glb");
    EXPECT_LT(mean_squared_error(base_color_of(back, 0).image, test_image(3, 40, 30)), 4e-3);
    expect_same_image(base_color_of(back, 1).image, base_color_of(model, 1).image);

    save_model(folder / "both.glb", model, base_color_edit(model, 2));
    const GltfFile both = read_gltf_file(folder / "both.glb");
    EXPECT_FALSE(both.json.contains("extensionsUsed"));
    EXPECT_FALSE(both.json.contains("extensionsRequired"));
    for (const OrderedJson& image : both.json["images"])
        EXPECT_EQ(image["mimeType"], "image/jpeg");
}

TEST(Textures, NeedNoExtensionToNameAnyFormat) {
    const fs::path folder = fresh_folder("texture_plain");
    write_textured(folder / "a.gltf",
                   {{"a.ktx2", ktx2_file("uastc")},
                    {"b.webp", encode_texture(test_image(4), lossless_webp, 8)}},
                   {{{"source", 0}}, {{"source", 1}}}, textured_materials(2));
    const Model model = load_model(folder / "a.gltf");
    EXPECT_LT(mean_squared_error(base_color_of(model, 0).image, test_image(3)), 5e-4);
    expect_same_image(base_color_of(model, 1).image, test_image(4), 1e-6f);
}

TEST(Textures, OfAnExtensionFallBackOnTheirOwnImage) {
    const fs::path folder = fresh_folder("texture_fallback");
    Bytes broken = ktx2_file("etc1s");
    broken.resize(300);
    OrderedJson texture = extension_texture("KHR_texture_basisu", 0);
    texture["source"] = 1;
    write_textured(folder / "a.gltf",
                   {{"a.ktx2", broken}, {"b.png", encode_texture(test_image(3), {}, 8)}},
                   OrderedJson::array({texture}), textured_materials(1),
                   {{"extensionsUsed", {"KHR_texture_basisu"}}});
    expect_same_image(base_color_of(load_model(folder / "a.gltf"), 0).image, test_image(3), 1e-6f);
    // A viewer that reads both images prefers the extension's. The output must work in all viewers.
    write_quickly(folder / "a.ktx2", ktx2_file("uastc"));
    const Model model = load_model(folder / "a.gltf");
    EXPECT_GT(mean_squared_error(base_color_of(model, 0).image, test_image(3)), 0);
    EXPECT_EQ(base_color_of(model, 0).coding, ImageCoding{});
}

TEST(Textures, WithoutAImageThatIsReadKeepTheFactors) {
    const fs::path folder = fresh_folder("texture_none");
    write_textured(folder / "a.gltf", {{"a.dds", Bytes{'D', 'D', 'S', ' ', 1, 2, 3, 4}}},
                   OrderedJson::array({extension_texture("MSFT_texture_dds", 0)}),
                   textured_materials(1));
    testing::internal::CaptureStderr();
    const Model model = load_model(folder / "a.gltf");
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(model.materials[0].base_color_texture, -1);
    EXPECT_NE(said.find("MSFT_texture_dds"), std::string::npos) << said;
    EXPECT_NE(said.find("factors are used"), std::string::npos) << said;
}

// The edit has no losses of the source. Compared with it, an edited JPEG is less than half a
// decibel worse than PNG.
TEST(Textures, OfJpegStayJpegOfLikeQuality) {
    const fs::path folder = fresh_folder("texture_jpeg");
    Image truth(256, 256, 3);
    std::uint32_t random = 7;
    for (int y = 0; y < truth.height; ++y) {
        for (int x = 0; x < truth.width; ++x) {
            random = random * 1664525u + 1013904223u;
            const float noise = static_cast<float>(random >> 16 & 255) / 255.0f - 0.5f;
            const float waves =
                std::sin(0.11f * static_cast<float>(x)) * std::cos(0.07f * static_cast<float>(y));
            truth.at(x, y, 0) = 0.5f + 0.3f * waves + 0.08f * noise;
            truth.at(x, y, 1) = 0.4f + 0.2f * waves * waves + 0.08f * noise;
            truth.at(x, y, 2) = (x / 32 + y / 32) % 2 ? 0.3f : 0.6f;
        }
    }
    const auto edited = [](Image image) {
        for (std::size_t i = 0; i < image.pixels.size(); i += 3)
            image.pixels[i] = std::min(1.0f, 0.7f * image.pixels[i] + 0.2f);
        return image;
    };
    for (const int quality : {50, 75, 90, 95}) {
        const Bytes jpeg = encode_texture(truth, {ImageEncoding::jpeg, false, quality}, 8);
        write_textured(folder / "a.gltf", {{"a.jpg", jpeg}}, {{{"source", 0}}},
                       textured_materials(1));
        const Model model = packed(folder / "a.gltf");
        ModelEdit edit;
        edit.materials[0].base_color = edited(base_color_of(model, 0).image);
        choose_codings(model, TextureFormat::keep, edit);
        ASSERT_EQ(edit.materials[0].base_color.coding().encoding, ImageEncoding::jpeg);
        save_model(folder / "b.glb", model, edit);
        const GltfFile file = read_gltf_file(folder / "b.glb");
        EXPECT_EQ(file.json["images"].size(), 1u);
        EXPECT_EQ(file.json["images"][0]["mimeType"], "image/jpeg");
        const Bytes png = encode_texture(*edit.materials[0].base_color, {}, 8);
        EXPECT_LT(image_bytes(file, 0).size(), std::min(png.size(), 2 * jpeg.size()));
        const double of_png = mean_squared_error(*edit.materials[0].base_color, edited(truth));
        const double of_jpeg =
            mean_squared_error(base_color_of(load_model(folder / "b.glb"), 0).image, edited(truth));
        const double loss = 10 * std::log10(of_jpeg / of_png);
        EXPECT_LT(loss, 0.5) << quality;
    }
}

TEST(Textures, OfLossyWebpStayWebpOfLikeQuality) {
    const fs::path folder = fresh_folder("texture_lossy_webp");
    const Image truth = test_image(3, 200, 160);
    const Bytes webp = encode_texture(truth, {ImageEncoding::webp, false, 75}, 8);
    write_textured(folder / "a.gltf", {{"a.webp", webp}},
                   OrderedJson::array({extension_texture("EXT_texture_webp", 0)}),
                   textured_materials(1));
    const Model model = packed(folder / "a.gltf");
    ModelEdit edit;
    edit.materials[0].base_color = base_color_of(model, 0).image;
    choose_codings(model, TextureFormat::keep, edit);
    EXPECT_FALSE(edit.materials[0].base_color.coding().is_lossless);
    save_model(folder / "b.glb", model, edit);
    const double loss =
        10 *
        std::log10(mean_squared_error(base_color_of(load_model(folder / "b.glb"), 0).image, truth) /
                   mean_squared_error(base_color_of(model, 0).image, truth));
    EXPECT_LT(loss, 0.5);
}

TEST(Textures, ThatMustNotLoseAreWrittenWithoutLosses) {
    Model model;
    model.materials.resize(1);
    Texture texture;
    texture.image = test_image(3);
    texture.coding = {ImageEncoding::jpeg, false, 90};
    model.textures = {texture};
    Material& material = model.materials[0];
    material.base_color_texture = material.metallic_roughness_texture = 0;
    ModelEdit edit;
    MaterialEdit& changed = edit.materials[0];
    changed.base_color = test_image(4);
    changed.metallic_roughness = test_image(3);
    changed.normal = test_image(3);
    choose_codings(model, TextureFormat::keep, edit);
    EXPECT_EQ(changed.base_color.coding(), ImageCoding{});  // has alpha
    EXPECT_EQ(changed.metallic_roughness.coding().encoding, ImageEncoding::jpeg);
    EXPECT_EQ(changed.normal.coding().encoding, ImageEncoding::jpeg);  // like the base colour
    changed.keeps_orm_texels = true;
    choose_codings(model, TextureFormat::keep, edit);
    EXPECT_EQ(changed.metallic_roughness.coding(), (ImageCoding{ImageEncoding::jpeg, false, 95}));
    choose_codings(model, TextureFormat::webp, edit);
    EXPECT_EQ(changed.metallic_roughness.coding(), lossless_webp);
    EXPECT_FALSE(changed.base_color.coding().is_lossless);
    model.textures[0].coding = {};
    choose_codings(model, TextureFormat::keep, edit);
    EXPECT_EQ(changed.metallic_roughness.coding(), ImageCoding{});
    choose_codings(model, TextureFormat::webp, edit);
    EXPECT_EQ(changed.normal.coding().encoding, ImageEncoding::webp);
    EXPECT_FALSE(changed.normal.coding().is_lossless);  // a new normal map is smooth
    choose_codings(model, TextureFormat::jpeg, edit);
    EXPECT_EQ(changed.normal.coding().encoding, ImageEncoding::jpeg);
    EXPECT_EQ(changed.base_color.coding(), ImageCoding{});
}

TEST(Textures, ThatMaterialsShareAreWrittenOnce) {
    const fs::path folder = fresh_folder("texture_shared");
    OrderedJson materials = textured_materials(1);
    materials.push_back(materials[0]);
    write_textured(folder / "a.gltf", {{"a.png", encode_texture(test_image(3), {}, 8)}},
                   {{{"source", 0}}}, materials);
    const Model model = load_model(folder / "a.gltf");
    ModelEdit edit;
    edit.materials[0].base_color = edit.materials[1].base_color = test_image(3, 40, 30);
    save_model(folder / "b.glb", model, edit);
    const GltfFile file = read_gltf_file(folder / "b.glb");
    EXPECT_EQ(file.json["images"].size(), 1u);
    EXPECT_EQ(file.json["textures"].size(), 1u);
    EXPECT_EQ(base_color_of(load_model(folder / "b.glb"), 1).image.width, 40);

    fs::create_directories(folder / "obj");
    save_model(folder / "obj" / "b.obj", model, edit);
    const auto images = std::count_if(
        fs::directory_iterator(folder / "obj"), fs::directory_iterator(),
        [](const fs::directory_entry& file_) { return file_.path().extension() == ".png"; });
    EXPECT_EQ(images, 1);
}

#ifdef ITEM3D_WRITES_KTX2  // the loaders' own build has no encoder
TEST(Textures, AreWrittenAsKtx2) {
    const fs::path folder = fresh_folder("texture_ktx2");
    write_textured(folder / "a.gltf", {{"a.png", encode_texture(test_image(3), {}, 8)}},
                   {{{"source", 0}}}, textured_materials(1));
    const Model model = load_model(folder / "a.gltf");
    ModelEdit edit;
    MaterialEdit& changed = edit.materials[0];
    Image smooth(64, 32, 3);
    for (int y = 0; y < smooth.height; ++y) {
        for (int x = 0; x < smooth.width; ++x) {
            smooth.at(x, y, 0) = 0.3f + 0.4f * static_cast<float>(x) / 64;
            smooth.at(x, y, 1) = 0.2f + 0.5f * static_cast<float>(y) / 32;
            smooth.at(x, y, 2) = 0.5f;
        }
    }
    changed.base_color = smooth;
    changed.normal = smooth;
    changed.metallic_roughness = test_image(3, 30, 30);  // the sides are not multiples of four
    choose_codings(model, TextureFormat::ktx2, edit);
    EXPECT_EQ(changed.metallic_roughness.coding(), ImageCoding{});
    save_model(folder / "b.glb", model, edit);
    const GltfFile file = read_gltf_file(folder / "b.glb");
    EXPECT_EQ(file.json["extensionsRequired"], OrderedJson::array({"KHR_texture_basisu"}));
    EXPECT_EQ(file.json["images"].size(), 3u);

    const Model read = load_model(folder / "b.glb");
    const Material& material = read.materials[0];
    const auto error = [&](int texture) {
        return mean_squared_error(read.textures[static_cast<std::size_t>(texture)].image, smooth);
    };
    EXPECT_LT(error(material.base_color_texture), 1e-3);
    EXPECT_LT(error(material.normal_texture), 1e-4);
}
#endif

// The file has three textures, and the edit replaces the first. The second is also the emission of
// the third material.
TEST(Textures, ThatAreReplacedLeaveTheFileAndIndicesFollow) {
    const fs::path folder = fresh_folder("texture_unused");
    std::map<std::string, Bytes> images;
    OrderedJson textures = OrderedJson::array();
    for (int i = 0; i < 3; ++i) {
        images["t" + std::to_string(i) + ".png"] =
            encode_texture(test_image(3, 20 + 9 * i, 22), {}, 8);
        textures.push_back({{"source", i}});
    }
    OrderedJson materials = textured_materials(3);
    materials[2]["emissiveTexture"]["index"] = 1;
    materials[2]["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]["index"] = 2;
    write_textured(folder / "a.gltf", images, textures, materials,
                   {{"asset", {{"copyright", "CC-BY Somebody"}, {"generator", "Modeller 3"}}},
                    {"extensionsUsed", {"KHR_materials_clearcoat"}}});
    const Model model = packed(folder / "a.gltf");
    const GltfFile before = read_gltf_file(folder / "a_packed.glb");
    save_model(folder / "b.glb", model, base_color_edit(model, 1));
    const GltfFile file = read_gltf_file(folder / "b.glb");
    EXPECT_EQ(file.json["textures"].size(), 3u);
    EXPECT_EQ(file.json["images"].size(), 3u);
    EXPECT_EQ(file.json["bufferViews"].size(), before.json["bufferViews"].size());
    EXPECT_FALSE(contains(file.binary, images["t0.png"]));
    EXPECT_TRUE(contains(file.binary, images["t1.png"]));
    EXPECT_TRUE(contains(file.binary, images["t2.png"]));
    EXPECT_EQ((file.json["buffers"][0]["byteLength"].get<std::size_t>() + 3) / 4 * 4,
              file.binary.size());
    EXPECT_EQ(file.json["asset"]["copyright"], "CC-BY Somebody");
    EXPECT_EQ(file.json["asset"]["generator"], "Modeller 3, edited with item3d");
    EXPECT_EQ(file.json["materials"][2]["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]
                       ["index"],
              file.json["materials"][2]["pbrMetallicRoughness"]["baseColorTexture"]["index"]);
    const Model back = load_model(folder / "b.glb");
    expect_same_image(base_color_of(back, 0).image, test_image(3, 40, 30), 1e-6f);
    expect_same_image(base_color_of(back, 1).image, base_color_of(model, 1).image);
    expect_same_image(base_color_of(back, 2).image, base_color_of(model, 2).image);
    EXPECT_EQ(back.materials[2].emissive_texture, back.materials[1].base_color_texture);
    expect_same_triangles(model, back);

    // A .gltf leaves no file of a replaced image beside it either.
    const fs::path other = folder / "other";
    fs::create_directories(other);
    const Model loose = load_model(folder / "a.gltf");
    save_model(other / "c.gltf", loose, base_color_edit(loose, 1));
    EXPECT_FALSE(fs::exists(other / "t0.png"));
    EXPECT_TRUE(fs::exists(other / "t1.png"));
    expect_same_image(base_color_of(load_model(other / "c.gltf"), 2).image,
                      base_color_of(model, 2).image);
}

TEST(Textures, StayWhereAnythingElseMayReferToThem) {
    const fs::path folder = fresh_folder("texture_referred");
    const Bytes png = encode_texture(test_image(3), {}, 8);
    const auto left = [&](const OrderedJson& root) {
        write_textured(folder / "a.gltf", {{"t.png", png}}, {{{"source", 0}}},
                       textured_materials(1), root);
        const Model model = packed(folder / "a.gltf");
        save_model(folder / "b.glb", model, base_color_edit(model, 1));
        return contains(read_gltf_file(folder / "b.glb").binary, png);
    };
    EXPECT_FALSE(left(OrderedJson::object()));
    EXPECT_TRUE(left({{"extensions", {{"VENDOR_cards", {{"card", 0}}}}}}));
    EXPECT_TRUE(left({{"extensions", {{"VRM", {{"meta", {{"texture", 0}}}}}}}}));
    // The avatar's own table of materials refers to the new texture, so the old one can go.
    const OrderedJson properties = {{{"textureProperties", {{"_MainTex", 0}}}}};
    EXPECT_FALSE(left({{"extensions", {{"VRM", {{"materialProperties", properties}}}}}}));
    EXPECT_TRUE(left({{"extensions", {{"VRMC_vrm", {{"meta", {{"thumbnailImage", 0}}}}}}}}));
}

TEST(Textures, OfAnObjStayTheirFilesByteForByte) {
    const fs::path folder = fresh_folder("texture_obj");
    const Bytes jpeg = encode_texture(test_image(3), {ImageEncoding::jpeg, false, 80}, 8);
    const Bytes webp = encode_texture(test_image(3), lossless_webp, 8);
    write_quickly(folder / "a.jpg", jpeg);
    write_quickly(folder / "b.webp", webp);
    write_atomically(folder / "a.mtl", std::string_view("newmtl a\nmap_Kd a.jpg\nnewmtl b\nmap_Kd "
                                                        "b.webp\n"));
    write_atomically(folder / "a.obj",
                     std::string_view("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt "
                                      "0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 3/3 2/2 1/1\n"));
    const Model model = load_model(folder / "a.obj");
    save_model(folder / "b.glb", model);
    const GltfFile file = read_gltf_file(folder / "b.glb");
    EXPECT_TRUE(contains(file.binary, jpeg));
    EXPECT_TRUE(contains(file.binary, webp));
    EXPECT_TRUE(is_listed(file.json, "extensionsRequired", "EXT_texture_webp"));
    expect_same_image(base_color_of(load_model(folder / "b.glb"), 1).image, test_image(3), 1e-6f);
    fs::create_directories(folder / "copy");
    save_model(folder / "copy" / "c.obj", model);
    EXPECT_EQ(read_bytes(folder / "copy" / "c_a_base_color.jpg"), jpeg);
    EXPECT_EQ(read_bytes(folder / "copy" / "c_b_base_color.webp"), webp);
}

TEST(Textures, OfMaterialsOfOneNameGetFilesOfTheirOwn) {
    const fs::path folder = fresh_folder("texture_names");
    const std::vector<std::string> names = {
        "dup", "dup", "Dup", "a/b", "a:b", std::string(300, 'x'), std::string(300, 'x')};
    const auto count = static_cast<int>(names.size());
    std::map<std::string, Bytes> images;
    OrderedJson textures = OrderedJson::array();
    OrderedJson materials = textured_materials(count);
    for (int i = 0; i < count; ++i) {
        images["t" + std::to_string(i) + ".png"] = encode_texture(test_image(3), {}, 8);
        textures.push_back({{"source", i}});
        materials[static_cast<std::size_t>(i)]["name"] = names[static_cast<std::size_t>(i)];
    }
    write_textured(folder / "a.gltf", images, textures, materials);
    const Model model = load_model(folder / "a.gltf");
    for (const char* extension : {".gltf", ".obj"}) {
        const fs::path out = folder / (std::string("out") + (extension + 1));
        fs::create_directories(out);
        save_model(out / ("b" + std::string(extension)), model, base_color_edit(model, count));
        const Model back = load_model(out / ("b" + std::string(extension)));
        ASSERT_EQ(back.textures.size(), names.size());
        for (int i = 0; i < count; ++i) {
            EXPECT_EQ(base_color_of(back, static_cast<std::size_t>(i)).image.width, 40 + i)
                << extension << ' ' << i;
        }
    }
    FileNames files;
    EXPECT_EQ(files.unused("a"), "a");
    EXPECT_EQ(files.unused("A"), "A_1");
    EXPECT_EQ(files.unused("a_1"), "a_1_1");
    EXPECT_EQ(shortened("a\xc3\xa9", 2), "a");
}

}  // namespace
}  // namespace item3d
