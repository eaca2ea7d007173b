// Tests of the initial metallic and roughness, which follow from the sentences, also where the
// values in the file mean nothing.
#include "item3d/edit/material_start.h"

#include "tests/support/field_models.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

PriorVocabulary make_vocabulary() {
    return PriorVocabulary(
        {{"vocabulary",
          {{"materials",
            {{{"word", "gold"}, {"spellings", {"gold", "golden"}}, {"roughness", 0.25}},
             {{"word", "chrome"}, {"roughness", 0.08}},
             {{"word", "wood"}, {"spellings", {"wood", "wooden"}}}}}}}},
        "prior.json");
}

EditPlan plan_of(const std::string& from, const std::string& to) {
    EditSettings settings;
    settings.from = from;
    settings.to = to;
    settings.metallic_start = 0.75f;
    return EditPlan(settings);
}

/// Returns a quad without textures.
Model make_factors(float metallic, float roughness) {
    Model model = testing::make_model(testing::make_quad());
    model.textures.clear();
    Material& material = model.materials[0];
    material.base_color_texture = material.metallic_roughness_texture = -1;
    material.occlusion_texture = -1;
    material.metallic_factor = metallic;
    material.roughness_factor = roughness;
    return model;
}

MaterialStart start_of(const Model& model, const std::string& from, const std::string& to) {
    return choose_start(plan_of(from, to), make_vocabulary(), model, {0});
}

const Model paint = make_factors(0, 0.5f);
const Model metal = make_factors(1, 0.4f);
const Model defaults = make_factors(1, 1);

TEST(MaterialStart, MetallicBeginsOnItsWayWhereOneSentenceNamesAMetal) {
    EXPECT_EQ(start_of(paint, "a wooden door", "a steel door").metallic, 0.75f);
    EXPECT_EQ(start_of(metal, "a steel door", "a wooden door").metallic, 0.25f);
    EXPECT_FALSE(start_of(metal, "a silver ring", "a golden ring").metallic);
    EXPECT_EQ(start_of(paint, "a silver ring", "a golden ring").metallic, 0.75f);
    EXPECT_FALSE(start_of(paint, "a red mug", "a blue mug").metallic);
}

TEST(MaterialStart, RoughnessIsThatOfTheMetalThatIsNew) {
    EXPECT_EQ(start_of(paint, "a red mug", "a golden mug").roughness, 0.25f);
    EXPECT_EQ(start_of(metal, "a golden mug", "a chrome mug").roughness, 0.08f);
    EXPECT_FALSE(start_of(metal, "a golden mug", "a golden mug with a dent").roughness);
    EXPECT_TRUE(start_of(paint, "a red mug", "a pewter mug").roughness);
    EXPECT_FALSE(start_of(paint, "a red mug", "a wooden mug").roughness);
    EXPECT_FALSE(start_of(paint, "a red mug", "a red mug with a golden handle").roughness);
}

TEST(MaterialStart, MetalThatNobodyChoseEndsWhereNoMetalIsNamed) {
    const MaterialStart start = start_of(defaults, "a cake", "a chocolate cake");
    EXPECT_EQ(start.metallic, 0.25f);
    EXPECT_TRUE(start.channels.metallic);
    EXPECT_EQ(start_of(defaults, "a soldier", "a golden soldier").metallic, 0.75f);
    // A metal drum stays metallic if it is painted, but not if it becomes wood.
    EXPECT_FALSE(start_of(metal, "a red drum", "a blue drum").channels.metallic);
    EXPECT_EQ(start_of(metal, "a red drum", "a wooden drum").metallic, 0.25f);
}

TEST(MaterialStart, KeptChannelsAreKept) {
    EditSettings settings;
    settings.from = "a cake";
    settings.to = "a golden cake";
    settings.keep = {"metallic", "roughness"};
    const MaterialStart start = choose_start(EditPlan(settings), make_vocabulary(), defaults, {0});
    EXPECT_FALSE(start.metallic);
    EXPECT_FALSE(start.roughness);
    EXPECT_FALSE(start.channels.metallic);
}

}  // namespace
}  // namespace item3d
