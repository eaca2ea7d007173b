// item3d caption and item3d score.
#include "cli_support.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace item3d::testing {
namespace {

std::string captioner() {
    return " --captioner '" ITEM3D_TEST_DATA "/models/blip'";
}

TEST_F(Program, CaptionsAPictureAndAModel) {
    const fs::path picture = folder_ / "picture.png";
    ASSERT_EQ(run("render " + quoted(cube_) + " --size 64x48 -o " + quoted(picture)).code, 0);
    const Result one = run("caption " + quoted(picture) + captioner() + " --max-tokens 5");
    EXPECT_EQ(one.code, 0) << one.error;
    EXPECT_EQ(std::count(one.out.begin(), one.out.end(), '\n'), 1) << one.out;

    const Result views = run("caption " + quoted(cube_) + captioner() +
                             " --views 2 --beams 2 --prefix 'a photo of' --max-tokens 4 --json");
    ASSERT_EQ(views.code, 0) << views.error;
    const auto captions = nlohmann::json::parse(views.out).at("captions");
    ASSERT_EQ(captions.size(), 2u);
    EXPECT_EQ(captions[0].get<std::string>().rfind("a photo of", 0), 0u) << captions[0];
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

TEST_F(Program, CaptionAndScoreNameWhatTheyLack) {
    expect_error("caption " + quoted(cube_) + " --captioner /nowhere", 3, "/nowhere/config.json");
    expect_error("caption " + quoted(folder_ / "no.png") + captioner(), 3, "no.png");
    expect_error("caption " + quoted(cube_) + captioner() + " --precision fp8", 3, "--precision");
    const std::string models = quoted(cube_) + " " + quoted(cube_) + " --from a --to b --clip ";
    expect_error("score " + models + "/nowhere", 3, "/nowhere/config.json");
    expect_error("score " + models + "'" ITEM3D_TEST_DATA "/models/blip'", 3, "CLIPModel");
}

}  // namespace
}  // namespace item3d::testing
