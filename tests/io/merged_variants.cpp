// Tests of several edits of one model that become variants in one file.
#include "tests/support/merged_variants.h"

#include "item3d/core/error.h"
#include "item3d/io/read_provenance.h"

#include <set>

namespace item3d {
namespace {

using namespace testing_support;

TEST_F(MergedVariants, EachEditIsALookOfTheSameVertices) {
    begin("looks", shop_quad());
    add("a golden quad", plain_edit(Vec3(1, 1, 0), true));
    add("The blue quad", plain_edit(Vec3(0, 0, 1), true));
    add("a golden quad", plain_edit(Vec3(0, 1, 0)));
    write_variants(request_);
    EXPECT_EQ(names(),
              (std::vector<std::string>{"original", "golden quad", "blue quad", "golden quad 2"}));
    EXPECT_EQ(color_in(""), Vec3(1, 0, 0));
    EXPECT_EQ(color_in("original"), Vec3(1, 0, 0));
    EXPECT_EQ(color_in("golden quad"), Vec3(1, 1, 0));
    EXPECT_EQ(color_in("blue quad"), Vec3(0, 0, 1));
    EXPECT_EQ(color_in("golden quad 2"), Vec3(0, 1, 0));
    EXPECT_EQ(color_in("golden quad", 1), color_in("", 1));

    const GltfJson json = read_gltf_file(request_.output).json;
    const GltfJson source = read_gltf_file(request_.model).json;
    EXPECT_EQ(json["accessors"], source["accessors"]);
    // The images are the red texture, three base colours, and one roughness image that two variants
    // share.
    EXPECT_EQ(json["images"].size(), 5u);
    EXPECT_EQ(json["textures"].size(), 5u);
    EXPECT_EQ(json["samplers"].size(), 1u);
    const GltfJson& primitives = json["meshes"][0]["primitives"];
    EXPECT_EQ(primitives[0]["material"], 0);
    EXPECT_FALSE(primitives[1].contains("extensions"));
    // three.js requires that each mapping has a material and that no variant occurs twice.
    std::set<int> mapped;
    for (const GltfJson& mapping :
         primitives[0]["extensions"]["KHR_materials_variants"]["mappings"]) {
        EXPECT_LT(mapping["material"].get<std::size_t>(), json["materials"].size());
        for (const GltfJson& variant : mapping["variants"])
            EXPECT_TRUE(mapped.insert(variant.get<int>()).second);
    }
    EXPECT_EQ(mapped, (std::set<int>{0, 1, 2, 3}));
    std::set<std::string> material_names;
    for (const GltfJson& material : json["materials"])
        EXPECT_TRUE(material_names.insert(material["name"].get<std::string>()).second);
}

TEST_F(MergedVariants, SaysOfWhichEditsItIs) {
    begin("claims", shop_quad());
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    add("a blue quad", plain_edit(Vec3(0, 0, 1)));
    request_.names = {"Gold", "Blue"};
    write_variants(request_);
    const FileProvenance provenance = read_provenance(request_.output);
    EXPECT_TRUE(provenance.is_unchanged());
    EXPECT_EQ(provenance.images.size(), 2u);
    const std::vector<EditClaim> edits = edits_of(provenance.metadata.claim);
    ASSERT_EQ(edits.size(), 2u);
    EXPECT_EQ(edits[0].to, "a golden quad");
    EXPECT_EQ(edits[0].variant, "Gold");
    EXPECT_EQ(edits[1].variant, "Blue");
    const Bytes once = read_bytes(request_.output);
    write_variants(request_);
    EXPECT_EQ(read_bytes(request_.output), once);
    request_.says_provenance = false;
    write_variants(request_);
    EXPECT_FALSE(read_provenance(request_.output).has_claim());
    request_.says_provenance = true;
    request_.output = folder_ / "files" / "shop.gltf";
    fs::create_directories(folder_ / "files");
    write_variants(request_);
    EXPECT_EQ(color_in("Blue"), Vec3(0, 0, 1));
    EXPECT_TRUE(read_provenance(request_.output).is_unchanged());
}

TEST_F(MergedVariants, AModelKeepsItsOwn) {
    GltfQuad quad = shop_quad();
    quad.json["extensions"]["KHR_materials_variants"]["variants"] =
        GltfJson::array({GltfJson{{"name", "one"}}, GltfJson{{"name", "two"}}});
    quad.json["materials"].push_back(
        GltfJson{{"name", "two"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 1, 1}}}}});
    quad.primitive()["extensions"]["KHR_materials_variants"]["mappings"] =
        GltfJson::array({GltfJson{{"material", 2}, {"variants", {1}}}});
    quad.use("KHR_materials_variants");
    begin("own", quad);
    ModelEdit second;
    second.materials[2].base_color = plain_image(16, Vec3(1, 0, 1));
    add("a two", plain_edit(Vec3(1, 1, 0)));
    add("a pink quad", second, "two");
    write_variants(request_);
    EXPECT_EQ(names(), (std::vector<std::string>{"one", "two", "two 2", "pink quad"}));
    EXPECT_EQ(color_in(""), Vec3(1, 0, 0));
    EXPECT_EQ(color_in("one"), Vec3(1, 0, 0));
    EXPECT_EQ(color_in("two"), Vec3(0, 1, 1));
    EXPECT_EQ(color_in("two 2"), Vec3(1, 1, 0));
    EXPECT_EQ(color_in("pink quad"), Vec3(1, 0, 1));
    request_.original = "two";
    EXPECT_NE(problem().find("is already the name of another variant"), std::string::npos);
    request_.original = "plain";
    write_variants(request_);
    EXPECT_EQ(color_in("plain"), Vec3(1, 0, 0));
}

TEST_F(MergedVariants, ANewUvMapIsEveryonesWhereEditsAgree) {
    GltfQuad quad = shop_quad();
    quad.json["nodes"].push_back(GltfJson{{"mesh", 0}, {"translation", {0, 0, 9}}});
    quad.json["scenes"][0]["nodes"].push_back(1);
    begin("uvs", quad);
    const Model source = load_model(request_.model);
    ModelEdit golden = plain_edit(Vec3(1, 1, 0));
    golden.primitives[0] = exploded(source.primitives[0]);
    ModelEdit blue = plain_edit(Vec3(0, 0, 1));
    blue.primitives[0] = golden.primitives[0];
    add("a golden quad", golden);
    add("a blue quad", blue);
    ModelEdit handle;
    handle.materials[1].base_color = plain_image(8, Vec3(0, 1, 0));
    add("a green handle", handle);
    write_variants(request_);
    for (const char* variant : {"", "original", "golden quad", "blue quad", "green handle"}) {
        SCOPED_TRACE(variant);
        const Model model = load_model(request_.output, {.variant = variant});
        const bool is_source = std::string(variant).find("quad") == std::string::npos;
        expect_same_triangles(model, source, 0.0f, is_source);
        EXPECT_EQ(model.primitives[0].positions.size(), 6u);
        EXPECT_EQ(model.primitives[1].positions.size(), 4u);
    }
    EXPECT_EQ(color_in("blue quad"), Vec3(0, 0, 1));
    EXPECT_EQ(color_in("green handle", 1), Vec3(0, 1, 0));
    EXPECT_EQ(color_in("green handle"), Vec3(1, 0, 0));

    ModelEdit other = plain_edit(Vec3(1, 1, 1));
    other.primitives[0] = golden.primitives[0];
    other.primitives[0].uvs[0].x += 0.01f;
    add("a white quad", other);
    const fs::path out = request_.output;
    request_.output = folder_ / "none.glb";
    EXPECT_NE(problem().find("a different UV map"), std::string::npos) << problem();
    EXPECT_FALSE(fs::exists(request_.output));
    request_.output = out;
}

TEST_F(MergedVariants, WhatCannotShareVerticesOrIsNoEditOfTheModelIsRefused) {
    GltfQuad quad = shop_quad();
    begin("refused", quad);
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    request_.names = {"a", "b"};
    EXPECT_NE(problem().find("2 times, for 1 edits"), std::string::npos) << problem();
    request_.names = {"original"};
    EXPECT_NE(problem().find("the name of another variant"), std::string::npos);
    request_.names.clear();
    request_.output = folder_ / "shop.obj";
    EXPECT_NE(problem().find("expected .glb or .gltf"), std::string::npos);
    request_.output = request_.model;
    EXPECT_NE(problem().find("is the input model"), std::string::npos);
    request_.output = folder_ / "shop.glb";
    request_.edits = {folder_};
    EXPECT_NE(problem().find("has no edit.json"), std::string::npos);
    request_.edits = {folder_ / "0"};
    quad.material()["name"] = "other";
    request_.model = quad.write(folder_, "other.gltf");
    EXPECT_NE(problem().find("a different model"), std::string::npos);
    for (const char* record : {"{", "[]", "{}", R"({"to": 3, "edits": []})"}) {
        write_quickly(folder_ / "0" / "edit.json", Bytes(record, record + std::strlen(record)));
        EXPECT_NE(problem(), "") << record;
    }

    GltfQuad colored = shop_quad();
    colored.primitive()["attributes"]["COLOR_0"] =
        colored.add_floats({1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1}, "VEC4");
    request_.edits.clear();
    begin("colored", colored);
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    EXPECT_NE(problem().find("vertex colours"), std::string::npos) << problem();
    EXPECT_FALSE(fs::exists(request_.output));
}

TEST_F(MergedVariants, AnObjAndADefaultMaterialHaveLooksToo) {
    folder_ = fresh_folder("merged_obj");
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n";
    request_.model = folder_ / "a.obj";
    write_quickly(request_.model, Bytes(obj.begin(), obj.end()));
    request_.output = folder_ / "shop.glb";
    add("a golden thing", plain_edit(Vec3(1, 1, 0)));
    write_variants(request_);
    EXPECT_EQ(color_in("golden thing"), Vec3(1, 1, 0));
    EXPECT_NE(color_in("original"), Vec3(1, 1, 0));

    GltfQuad quad = shop_quad();
    quad.json["meshes"][0]["primitives"].erase(1);
    quad.json.erase("materials");
    quad.primitive().erase("material");
    request_.edits.clear();
    begin("default", quad);
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    write_variants(request_);
    EXPECT_EQ(color_in("golden quad"), Vec3(1, 1, 0));
    EXPECT_EQ(color_in("original"), Vec3(1));
    EXPECT_EQ(color_in(""), Vec3(1));
}

TEST_F(MergedVariants, DamagedEditsAreRefused) {
    begin("damaged", shop_quad());
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    const fs::path model = request_.edits[0] / "model.glb";
    const Bytes whole = read_bytes(model);
    int refused = 0;
    // The damaged bytes are in the header's lengths, in the JSON chunk, and at the end of the file.
    for (std::size_t i = 0; i < 2200 && i < whole.size(); i += 97) {
        Bytes changed = whole;
        changed[i] = static_cast<std::uint8_t>(changed[i] ^ 1 << i % 7);
        write_quickly(model, changed);
        try {
            write_variants(request_);
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 2);
}

}  // namespace
}  // namespace item3d
