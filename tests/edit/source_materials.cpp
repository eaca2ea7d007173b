// Tests of properties of a model's materials that conflict with an edit.
#include "item3d/edit/source_materials.h"

#include "tests/support/edit.h"

namespace item3d {
namespace {

EditPlan plan_to(const std::string& to) {
    EditSettings settings;
    settings.from = "a bottle";
    settings.to = to;
    return EditPlan(settings);
}

Model one_material() {
    Model model;
    model.materials.emplace_back();
    model.materials[0].name = "bottle";
    Image image(2, 2, 3, 0.5f);
    Image other(2, 2, 3, 0.25f);
    for (const Image& one : {image, image, other})
        model.textures.push_back({"", one});
    return model;
}

struct Prepared {
    MaterialLosses losses;
    std::string messages;
};

Prepared prepare(Model& model, const std::string& to) {
    ::testing::internal::CaptureStderr();
    MaterialLosses losses = prepare_materials(model, {0}, plan_to(to)).at(0);
    return {losses, ::testing::internal::GetCapturedStderr()};
}

TEST(SourceMaterials, WhatLetsLightThroughGoesWhereTheTargetIsOpaque) {
    Model model = one_material();
    const std::vector<std::string> glass = {"KHR_materials_transmission", "KHR_materials_volume"};
    model.materials[0].other_extensions = glass;
    EXPECT_EQ(prepare(model, "a golden bottle").losses.extensions, glass);
    EXPECT_EQ(prepare(model, "a bottle of wood").losses.extensions, glass);
    EXPECT_TRUE(prepare(model, "a blue bottle").losses.extensions.empty());
    EXPECT_NE(prepare(model, "a blue bottle").messages.find("keeps KHR_materials_transmission"),
              std::string::npos);
    EXPECT_EQ(prepare(model, "a bottle of green glass").messages, "");
    EXPECT_TRUE(prepare(model, "a bottle of gold and glass").losses.extensions.empty());
}

TEST(SourceMaterials, SheenGoesWithAllButCloth) {
    Model model = one_material();
    model.materials[0].other_extensions = {"KHR_materials_sheen"};
    EXPECT_EQ(prepare(model, "a bronze bottle").losses.extensions.size(), 1u);
    EXPECT_EQ(prepare(model, "a bottle of red velvet").messages, "");
    EXPECT_NE(prepare(model, "a red bottle").messages.find("keeps KHR_materials_sheen"),
              std::string::npos);
}

TEST(SourceMaterials, AFactorThatLetsLightThroughBecomesOpaque) {
    Model model = one_material();
    model.materials[0].alpha = Material::Alpha::blend;
    model.materials[0].base_color_factor.w = 0.3f;
    Model blue = model;
    EXPECT_NE(prepare(blue, "a blue bottle").messages.find("keeps its transparency"),
              std::string::npos);
    EXPECT_EQ(blue.materials[0].base_color_factor.w, 0.3f);
    EXPECT_TRUE(prepare(model, "a steel bottle").losses.transparency);
    EXPECT_EQ(model.materials[0].alpha, Material::Alpha::opaque);
    EXPECT_EQ(model.materials[0].base_color_factor.w, 1.0f);
}

TEST(SourceMaterials, EmissionOfTheBaseColourGoes) {
    Model model = one_material();
    model.materials[0].base_color_texture = 0;
    model.materials[0].emissive_texture = 1;  // has the same image as texture 0
    model.materials[0].emissive_factor = Vec3(1.0f);
    Model other = model;
    other.materials[0].emissive_texture = 2;
    EXPECT_TRUE(prepare(model, "a blue bottle").losses.emission);
    EXPECT_EQ(model.materials[0].emissive_factor, Vec3(0.0f));
    EXPECT_EQ(model.materials[0].emissive_texture, -1);
    const Prepared kept = prepare(other, "a blue bottle");
    EXPECT_FALSE(kept.losses.emission);
    EXPECT_EQ(other.materials[0].emissive_texture, 2);
    EXPECT_NE(kept.messages.find("separate emission"), std::string::npos);
}

TEST(SourceMaterials, EmissionAloneBecomesTheBaseColour) {
    Model model = one_material();
    model.materials[0].base_color_factor = Vec4(0, 0, 0, 1);
    model.materials[0].emissive_texture = 2;
    model.materials[0].emissive_factor = Vec3(1.0f, 0.5f, 1.0f);
    EXPECT_TRUE(prepare(model, "a blue bottle").losses.emission);
    EXPECT_EQ(model.materials[0].base_color_texture, 2);
    EXPECT_EQ(model.materials[0].base_color_factor, Vec4(1, 0.5f, 1, 1));
    EXPECT_EQ(model.materials[0].metallic_factor, 0.0f);
    EXPECT_EQ(model.materials[0].emissive_factor, Vec3(0.0f));
}

TEST(SourceMaterials, WhatUnlitHidStaysHidden) {
    Model model = one_material();
    model.materials[0].unlit = true;
    model.materials[0].emissive_texture = 2;
    model.materials[0].emissive_factor = Vec3(1.0f);
    EXPECT_TRUE(prepare(model, "a blue bottle").losses.emission);
    EXPECT_FALSE(model.materials[0].unlit);
    EXPECT_EQ(model.materials[0].emissive_factor, Vec3(0.0f));
}

TEST(SourceMaterials, VariantsThatChangeAndThatStay) {
    Model model = one_material();
    model.variants = {{"one", {0, 2}}, {"two", {1, 2}}};
    EXPECT_EQ(variants_with(model, {0}, true), std::vector<std::string>{"one"});
    EXPECT_EQ(variants_with(model, {0}, false), std::vector<std::string>{"two"});
    EXPECT_EQ(variants_with(model, {2}, true).size(), 2u);
}

class GltfEditTest : public testing::EditTest {
  protected:
    Model cube() const { return load_model(folder_ / "cube.glb"); }
};

TEST_F(GltfEditTest, AShadelessScanIsEditedAsASurfaceInLight) {
    Model model = cube();
    model.source = nullptr;
    model.materials[0].emissive_factor = Vec3(1.0f);
    model.materials[0].emissive_texture = model.materials[0].base_color_texture;
    save_model(folder_ / "cube.glb", model);
    edit_model(request("out", 1));
    const Material after = load_model(folder_ / "out" / "model.glb").materials[0];
    EXPECT_EQ(after.emissive_factor, Vec3(0.0f));
    EXPECT_EQ(after.emissive_texture, -1);
}

TEST_F(GltfEditTest, AnAvatarKeepsItsEnding) {
    testing::fs::rename(folder_ / "cube.glb", folder_ / "cube.vrm");
    EditRequest avatar = request("out", 0);
    avatar.model = folder_ / "cube.vrm";
    edit_model(avatar);
    EXPECT_FALSE(testing::fs::exists(folder_ / "out" / "model.glb"));
    EXPECT_EQ(load_model(folder_ / "out" / "model.vrm").primitives.size(), 1u);
}

}  // namespace
}  // namespace item3d
