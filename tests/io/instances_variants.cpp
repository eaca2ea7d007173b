// Tests of EXT_mesh_gpu_instancing and KHR_materials_variants.
#include "item3d/core/error.h"
#include "tests/support/gltf_quad.h"

namespace item3d {
namespace {

using namespace testing_support;

GltfQuad instanced_quad() {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(2, Vec3(1, 0, 0))));
    quad.json["nodes"][0]["translation"] = {0, 0, 5};
    GltfJson& attributes =
        quad.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = quad.add_floats({0, 0, 0, 10, 0, 0, 0, 20, 0}, "VEC3");
    const float half = std::sqrt(0.5f);
    attributes["ROTATION"] = quad.add_floats({0, 0, 0, 1, 0, 0, half, half, 0, 0, 0, 1}, "VEC4");
    attributes["SCALE"] = quad.add_floats({1, 1, 1, 3, 1, 1, -1, 1, 1}, "VEC3");
    quad.use("EXT_mesh_gpu_instancing", true);
    return quad;
}

TEST(Instancing, DrawsEachInstance) {
    const Model model = load_model(instanced_quad().write(fresh_folder("instancing")));
    ASSERT_EQ(model.primitives.size(), 3u);
    EXPECT_EQ(model.primitives[0].positions[1], Vec3(1, -1, 5));
    // The instance scales (1, -1) to (3, -1) and rotates it to (1, 3).
    const Vec3 turned = model.primitives[1].positions[1];
    EXPECT_NEAR(turned.x, 11, 1e-5);
    EXPECT_NEAR(turned.y, 3, 1e-5);
    EXPECT_EQ(model.primitives[2].positions[1], Vec3(-1, 19, 5));
    EXPECT_TRUE(model.primitives[2].is_mirrored);
    EXPECT_EQ(model.primitives[2].source_node, 0);
}

TEST(Instancing, StaysAsItIsInAnEditedFile) {
    GltfQuad quad = instanced_quad();
    const Model model = load_model(quad.write(fresh_folder("instancing_edit")));
    ModelEdit edit;
    edit.materials[0].base_color = plain_image(4, Vec3(0, 0, 1));
    for (int i = 0; i < 3; ++i)
        edit.primitives[i] = exploded(model.primitives[static_cast<std::size_t>(i)]);
    const fs::path path = fresh_folder("instancing_edit_out") / "out.gltf";
    save_model(path, model, edit);
    GltfJson json = read_gltf_file(path).json;
    EXPECT_EQ(json["nodes"], quad.json["nodes"]);
    EXPECT_EQ(json["meshes"].size(), 1u);
    EXPECT_EQ(json["extensionsRequired"], quad.json["extensionsRequired"]);
    const Model back = load_model(path);
    ASSERT_EQ(back.primitives.size(), 3u);
    EXPECT_EQ(back.primitives[0].positions.size(), 6u);
    EXPECT_EQ(back.bounds(), model.bounds());
}

TEST(Instancing, CountsThatDifferAreRefused) {
    GltfQuad quad = instanced_quad();
    quad.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        quad.add_floats({1, 1, 1}, "VEC3");
    EXPECT_THROW(load_model(quad.write(fresh_folder("instancing_bad"))), InputError);
}

TEST(NodeVisibility, HiddenNodesAndWhatHangsOnThemAreNotDrawn) {
    GltfQuad quad;
    quad.json["nodes"] =
        GltfJson::array({GltfJson{{"mesh", 0}, {"children", {1}}},
                         GltfJson{{"mesh", 0}, {"children", {2}}}, GltfJson{{"mesh", 0}}});
    quad.use("KHR_node_visibility", true);
    const fs::path folder = fresh_folder("visibility");
    quad.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = true;
    EXPECT_EQ(load_model(quad.write(folder)).primitives.size(), 3u);
    quad.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
    EXPECT_EQ(load_model(quad.write(folder)).primitives.size(), 1u);
}

/// Returns a quad with variants. The variant "one" has material 0, "two" has material 1, and the
/// file without a variant shows material 0. A second primitive has material 2 in all variants.
GltfQuad quad_of_variants() {
    GltfQuad quad;
    quad.json["extensions"]["KHR_materials_variants"]["variants"] =
        GltfJson::array({GltfJson{{"name", "one"}}, GltfJson{{"name", "two"}}});
    for (const char* name : {"b", "c"})
        quad.json["materials"].push_back(GltfJson{{"name", name}});
    GltfJson plain = quad.primitive();
    plain["material"] = 2;
    quad.primitive()["extensions"]["KHR_materials_variants"]["mappings"] =
        GltfJson::array({GltfJson{{"material", 0}, {"variants", {0}}},
                         GltfJson{{"material", 1}, {"variants", {1}}}});
    quad.json["meshes"][0]["primitives"].push_back(plain);
    quad.use("KHR_materials_variants");
    return quad;
}

TEST(Variants, OneIsShownByName) {
    const fs::path path = quad_of_variants().write(fresh_folder("variants"));
    EXPECT_EQ(load_model(path).primitives[0].material, 0);
    EXPECT_EQ(load_model(path, {.variant = "one"}).primitives[0].material, 0);
    const Model model = load_model(path, {.variant = "two"});
    EXPECT_EQ(model.primitives[0].material, 1);
    EXPECT_EQ(model.primitives[1].material, 2);
    ASSERT_EQ(model.variants.size(), 2u);
    EXPECT_EQ(model.variants[0].name, "one");
    EXPECT_EQ(model.variants[0].materials, (std::vector<int>{0, 2}));
    EXPECT_EQ(model.variants[1].materials, (std::vector<int>{1, 2}));
}

TEST(Variants, AnUnknownOneIsRefusedWithThoseThatThereAre) {
    const fs::path path = quad_of_variants().write(fresh_folder("variants_unknown"));
    try {
        load_model(path, {.variant = "three"});
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("one, two"), std::string::npos) << error.what();
    }
    EXPECT_THROW(load_model(GltfQuad().write(fresh_folder("variants_none")), {.variant = "one"}),
                 InputError);
}

TEST(Variants, TheShownOneIsEdited) {
    GltfQuad quad = quad_of_variants();
    const Model model = load_model(quad.write(fresh_folder("variants_edit")), {.variant = "two"});
    ModelEdit edit;
    edit.materials[1].base_color = plain_image(4, Vec3(0, 0, 1));
    edit.primitives[0] = exploded(model.primitives[0]);
    const fs::path path = fresh_folder("variants_edit_out") / "out.gltf";
    save_model(path, model, edit);
    GltfJson json = read_gltf_file(path).json;
    EXPECT_EQ(json["materials"][0], quad.material(0));
    EXPECT_EQ(json["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
    EXPECT_EQ(json["meshes"][0]["primitives"][0]["material"], 0);
    EXPECT_EQ(json["meshes"][0]["primitives"][0]["extensions"], quad.primitive()["extensions"]);
    EXPECT_GE(load_model(path, {.variant = "two"}).materials[1].base_color_texture, 0);
}

}  // namespace
}  // namespace item3d
