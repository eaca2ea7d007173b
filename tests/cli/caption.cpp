// Tests of item3d caption and item3d score.
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace item3d::testing {
namespace {

std::string captioner() {
    return " --captioner '" ITEM3D_TEST_DATA "/models/blip'";
}

TEST_F(Program, CaptionsAImageAndAModel) {
    const fs::path image = folder_ / "picture.png";
    ASSERT_EQ(run("render " + quoted(cube_) + " --size 64x48 -o " + quoted(image)).code, 0);
    const Result one = run("caption " + quoted(image) + captioner() + " --max-tokens 5");
    EXPECT_EQ(one.code, 0) << one.error;
    EXPECT_EQ(std::count(one.out.begin(), one.out.end(), '\n'), 1) << one.out;

    const Result views = run("caption " + quoted(cube_) + captioner() +
                             " --views 2 --beams 2 --prefix 'a photo of' --max-tokens 4 --json");
    ASSERT_EQ(views.code, 0) << views.error;
    const auto said = nlohmann::json::parse(views.out);
    ASSERT_EQ(said.at("of_views").size(), 2u);
    EXPECT_EQ(said.at("caption").get<std::string>().rfind("a photo of", 0), 0u) << said;
    EXPECT_EQ(said["of_views"][0].get<std::string>().rfind("a photo of", 0), 0u) << said;
}

TEST_F(Program, EditNamesWhatAnAdjustmentLacks) {
    const std::string edit =
        "edit " + quoted(cube_) + " --from 'a red cube' --to 'a blue cube' -o " +
        quoted(folder_ / "out") + " --prior '" ITEM3D_TEST_DATA "/models/pipeline_sd'";
    expect_error(edit + " --adjust caption", 3, "--captioner");
    expect_error(edit + " --adjust caption --captioner /nowhere", 3, "/nowhere/config.json");
    expect_error(edit + " --adjust sometimes", 3, "caption-paper");
    expect_error(edit + " --adjust caption --adjust-every 0" + captioner(), 3, "--adjust-every");
    expect_error(edit + " --adjust caption --adjust-strength 9" + captioner(), 3,
                 "--adjust-strength");
    expect_error(edit + " --settle 2", 3, "--settle");
}

TEST_F(Program, CaptionAndScoreTakeTheEmbeddedNetworks) {
    const std::string mug = quoted(fs::path(ITEM3D_TEST_DATA) / "../../assets/demo/mug.glb");
    const Result captions = run("caption " + mug + " --json");
    ASSERT_EQ(captions.code, 0) << captions.error;
    const auto said = nlohmann::json::parse(captions.out);
    EXPECT_EQ(said.at("of_views").size(), 4u);
    EXPECT_NE(said.at("caption").get<std::string>().find("red"), std::string::npos) << said;

    const auto score = [&](const std::string& to) {
        const Result result =
            run("score " + mug + " " + mug + " --from 'a mug' --to '" + to + "' --views 2 --json");
        EXPECT_EQ(result.code, 0) << result.error;
        return nlohmann::json::parse(result.out).at("global").get<double>();
    };
    EXPECT_GT(score("a red mug"), score("a blue chair"));
    const std::string cube = quoted(cube_);
    const Result cut = run("score " + cube + " " + cube + " --views 1 --from 'a mug' --to '" +
                           std::string(18, 'a') + " a red mug a red mug a red mug a red mug'");
    EXPECT_EQ(cut.code, 0);
    EXPECT_NE(cut.error.find("warning: --to: the text is longer than the limit of 24 tokens"),
              std::string::npos)
        << cut.error;

    const std::string nothing = "ITEM3D_ASSETS=" + quoted(folder_) + " ";
    EXPECT_NE(run("caption " + cube, nothing).error.find("--captioner"), std::string::npos);
    EXPECT_NE(run("score " + cube + " " + cube + " --from a --to b", nothing).error.find("--clip"),
              std::string::npos);
}

TEST_F(Program, CaptionAndScoreNameWhatTheyLack) {
    expect_error("caption " + quoted(cube_) + " --captioner /nowhere", 3, "/nowhere/config.json");
    expect_error("caption " + quoted(folder_ / "no.png") + captioner(), 3, "no.png");
    expect_error("caption " + quoted(cube_) + captioner() + " --precision fp8", 3, "--precision");
    const std::string pixel = quoted(folder_ / "pixel.png");
    ASSERT_EQ(run("render " + quoted(cube_) + " --size 1x1 -o " + pixel).code, 0);
    expect_error("caption " + pixel + captioner(), 3, "1 x 1 pixels");
    expect_error("caption " + quoted(cube_) + captioner() + " --max-tokens 1000", 3,
                 "shorten the prefix");
    const std::string models = quoted(cube_) + " " + quoted(cube_) + " --from a --to b --clip ";
    expect_error("score " + models + "/nowhere", 3, "/nowhere/config.json");
    expect_error("score " + models + "'" ITEM3D_TEST_DATA "/models/blip'", 3, "CLIPModel");
    expect_error("score " + quoted(cube_) + " " + quoted(cube_) + " --from ' ' --to b", 3,
                 "--from");
}

}  // namespace
}  // namespace item3d::testing
