// Tests of the table of settings: it is complete, invalid values are refused, and the page that is
// generated from it is current.
#include "item3d/edit/settings.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/settings_catalogue.h"
#include "item3d/edit/settings_table.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>

namespace item3d {
namespace {

/// Returns the error of a setting's value, or "" if the value is valid.
std::string refusal(const std::string& name, const nlohmann::json& value) {
    try {
        check_settings(nlohmann::json{{name, value}}.get<EditSettings>());
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(EditSettings, HaveNamesFlagsAndHelpOfTheirOwn) {
    std::set<std::string> names, flags;
    for (const Setting& row : settings_table()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_TRUE(row.flag.empty() || flags.insert(row.flag).second) << row.flag;
        EXPECT_FALSE(row.help.empty()) << row.name;
        EXPECT_NO_THROW(row.check({})) << row.name;
    }
}

TEST(EditSettings, AreTheSameAfterJson) {
    EditSettings settings;
    settings.lora = {"a", "b:0.5"};
    settings.adjust = Adjustment::caption_paper;
    settings.optimize = Optimize::both;
    settings.light_model = LightChoice::texels;
    settings.light_augment = LightAugment::rotate;
    settings.metallic = Metallic::always;
    settings.detail = Detail::off;
    settings.weighting = Weighting::late;
    settings.timestep_schedule = TimestepSchedule::dreamtime;
    settings.seed = 0xffffffffffffffffull;
    settings.settle = 0.3f;
    const nlohmann::json json = settings;
    EXPECT_EQ(json["adjust"], "caption-paper");
    EXPECT_EQ(json["light_model"], "texels");
    EXPECT_EQ(json["detail"], "off");
    EXPECT_EQ(json.size(), settings_table().size());
    const auto back = json.get<EditSettings>();
    EXPECT_EQ(nlohmann::json(back), json);
    EXPECT_EQ(back.seed, settings.seed);
    EXPECT_EQ(back.optimize, Optimize::both);
}

TEST(EditSettings, SayWhichOptionIsWrongAndWhatItMayBe) {
    EXPECT_EQ(refusal("optimize", "shape"), "--optimize: must be texture, light or both");
    EXPECT_EQ(refusal("light_model", "sphere"), "--light-model: must be auto, physical or texels");
    EXPECT_EQ(refusal("metallic", "no"), "--metallic: must be auto or always");
    EXPECT_EQ(refusal("batch", 65), "--batch: must be between 1 and 64");
    EXPECT_EQ(refusal("resolution", 8), "--resolution: must be between 16 and 2048 pixels");
    EXPECT_EQ(refusal("settle", 1), "--settle: must be between 0 (never) and 1");
    EXPECT_EQ(refusal("learning_rate", 0), "--learning-rate: must be above 0 and at most 1");
    EXPECT_NE(refusal("learning_rate", std::numeric_limits<float>::infinity()), "");
    EXPECT_EQ(refusal("cfg", std::numeric_limits<float>::quiet_NaN()),
              "--cfg: must be between -1000 and 1000");
    EXPECT_EQ(refusal("detail_views", 0), "detail_views: must be between 1 and 1000");
    EXPECT_EQ(refusal("light_from", {1, 2, 3}),
              "light_from: must be an azimuth and an elevation in degrees");
    for (const char* name : {"learned", "caption", "caption-paper", "off"})
        EXPECT_NE(refusal("adjust", "sometimes").find(name), std::string::npos) << name;
    EXPECT_NE(refusal("weighting", "heavy").find("--weighting"), std::string::npos);
    EXPECT_NE(refusal("timestep_schedule", "never").find("dreamtime"), std::string::npos);
    EXPECT_NE(refusal("keep", {"colour"}).find("'colour' is not a channel"), std::string::npos);
    EXPECT_EQ(refusal("settle", 0.5), "");
    EXPECT_EQ(refusal("seed", 7), "");
    EXPECT_THROW(refusal("seed", -1), nlohmann::json::exception);
}

TEST(EditSettings, AreAsTheSettingsPageHasThem) {
    const auto page = std::filesystem::path(ITEM3D_TEST_DATA) / "../../docs/reference/settings.md";
    if (std::getenv("ITEM3D_WRITE_DOCS") != nullptr) {
        make_output_folder(page.parent_path());
        write_atomically(page, settings_markdown());
    }
    ASSERT_TRUE(std::filesystem::exists(page)) << page;
    EXPECT_TRUE(read_text(page) == settings_markdown())
        << "docs/reference/settings.md is not as settings_table.cpp says; write it again by "
           "make reference";
}

TEST(EditSettings, AreAsTheStudioHasThem) {
    const auto file = std::filesystem::path(ITEM3D_TEST_DATA) / "../../web/settings.json";
    const std::string text = settings_catalogue().dump(1) + "\n";
    if (std::getenv("ITEM3D_WRITE_DOCS") != nullptr) write_atomically(file, text);
    ASSERT_TRUE(std::filesystem::exists(file)) << file;
    EXPECT_TRUE(read_text(file) == text)
        << "web/settings.json is not as settings_table.cpp says; write it again by make reference";
}

}  // namespace
}  // namespace item3d
