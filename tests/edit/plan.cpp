// Tests of what an edit derives from its settings, and of the places where settings come from.
#include "item3d/edit/plan.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

namespace item3d {
namespace {

namespace fs = std::filesystem;

EditPlan plan_of(const nlohmann::json& settings) {
    return EditPlan(settings.get<EditSettings>());
}

TEST(Metals, AreFoundAsWholeWords) {
    EXPECT_TRUE(names_metal("a Golden mug"));
    EXPECT_TRUE(names_metal("a mug of gold"));
    EXPECT_TRUE(names_metal("gold"));
    EXPECT_FALSE(names_metal("a marigold"));
    EXPECT_FALSE(names_metal("a goldfish in a tinderbox"));
    EXPECT_FALSE(names_metal(""));
}

TEST(EditPlan, MetallicIsLeftAloneWhereNoMetalIsNamed) {
    const auto is_edited = [](const std::string& to, const std::string& metallic) {
        return plan_of({{"from", "a red cube"}, {"to", to}, {"metallic", metallic}})
            .channels.metallic;
    };
    EXPECT_FALSE(is_edited("a wooden cube", "auto"));
    EXPECT_TRUE(is_edited("a wooden cube", "always"));
    EXPECT_TRUE(is_edited("a copper cube", "auto"));
}

TEST(EditPlan, DetailIsPaintedWhereTheTargetAloneNamesSuchAMaterial) {
    nlohmann::json settings = {{"from", "a red mug"}, {"to", "a Marble mug"}};
    const auto painted = [&](const nlohmann::json& more) {
        settings.update(more);
        return plan_of(settings).paints_detail;
    };
    EXPECT_FALSE(painted(nlohmann::json::object()));
    EXPECT_TRUE(painted({{"detail_words", {"wooden", "marble"}}}));
    EXPECT_EQ(plan_of(settings).total_iterations, 620);
    EXPECT_FALSE(painted({{"from", "a marble mug, red"}}));
    EXPECT_TRUE(painted({{"detail", "always"}}));
    EXPECT_FALSE(painted({{"keep", {"base_color"}}}));
    EXPECT_FALSE(painted({{"keep", nlohmann::json::array()}, {"iterations", 0}}));
}

TEST(EditPlan, WhatIsEditedFollowsFromOptimize) {
    const EditPlan texture = plan_of({{"optimize", "texture"}});
    EXPECT_TRUE(texture.edits_texture && !texture.edits_light);
    EXPECT_EQ(texture.light_variation, LightAugment::all);
    const EditPlan light = plan_of({{"optimize", "light"}});
    EXPECT_TRUE(!light.edits_texture && light.edits_light && !light.channels.any());
    const EditPlan both = plan_of({{"optimize", "both"}});
    EXPECT_TRUE(both.edits_texture && both.edits_light);
    EXPECT_EQ(both.light_variation, LightAugment::off);
}

TEST(EditPlan, ALightIsPhysicalForSmallPictures) {
    EXPECT_EQ(plan_of({{"resolution", 64}}).light_kind, LightKind::physical);
    EXPECT_EQ(plan_of({{"resolution", 512}}).light_kind, LightKind::texels);
    EXPECT_EQ(plan_of({{"resolution", 64}, {"light_model", "texels"}}).light_kind,
              LightKind::texels);
}

TEST(EditPlan, FewerIterationsComeBeforeTheDetailStageUnlessTheyAreGiven) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d-before-detail-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    write_atomically(folder / "prior.json", std::string_view(R"({"defaults": {"iterations": 150,
        "iterations_before_detail": 60, "detail_words": ["mossy"]}})"));
    const nlohmann::json painted = {{"from", "a cow"}, {"to", "a mossy cow"}};
    const auto with = [&](const nlohmann::json& more) {
        nlohmann::json overrides = painted;
        overrides.update(more);
        return resolve_plan(folder, overrides).iterations;
    };
    EXPECT_EQ(with(nlohmann::json::object()), 60);
    EXPECT_EQ(with({{"to", "a red cow"}}), 150);
    EXPECT_EQ(with({{"detail", "off"}}), 150);
    EXPECT_EQ(with({{"optimize", "both"}}), 150);
    EXPECT_EQ(with({{"iterations", 200}}), 200);
    EXPECT_THROW(with({{"iterations_before_detail", -1}}), InputError);
    fs::remove_all(folder);
}

TEST(EditPlan, PriorDefaultsAndOverridesAreMergedAndChecked) {
    const fs::path folder =
        fs::temp_directory_path() / ("item3d-prior-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    write_atomically(folder / "prior.json",
                     std::string_view(R"({"defaults": {"iterations": 150, "resolution": 64}})"));
    const EditPlan plan = resolve_plan(folder, {{"iterations", 20}});
    EXPECT_EQ(plan.iterations, 20);
    EXPECT_EQ(plan.resolution, 64);
    EXPECT_EQ(plan.timestep_schedule, TimestepSchedule::uniform);
    // A requested method brings its published settings, but values that are given take priority.
    const EditPlan inverted = resolve_plan(folder, {{"guidance", "sdi"}, {"cfg", 5}});
    EXPECT_EQ(inverted.timestep_schedule, TimestepSchedule::anneal);
    EXPECT_EQ(inverted.timesteps, (std::vector<float>{0.25f, 0.98f}));
    EXPECT_EQ(inverted.cfg, 5);
    EXPECT_EQ(inverted.resolution, 64);
    EXPECT_EQ(resolve_plan(folder, {{"optimize", "light"}}).guidance, "dds");
    EXPECT_THROW(resolve_plan(folder, {{"optimize", "light"}, {"region", {"auto"}}}), InputError);
    EXPECT_NO_THROW(resolve_plan(folder, {{"optimize", "light"}, {"region", {"all"}}}));
    EXPECT_THROW(resolve_plan(folder, {{"timesteps", {0.9, 0.1}}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"keep", {"colour"}}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"batch", 0}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"batch", "two"}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"evenness", -1}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"evenness", INFINITY}}), InputError);
    EXPECT_THROW(resolve_plan(folder, {{"detail", "some"}}), InputError);
    write_atomically(folder / "prior.json", std::string_view("[1"));
    EXPECT_THROW(resolve_plan(folder, {}), InputError);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace item3d
