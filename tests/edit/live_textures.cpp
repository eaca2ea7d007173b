// Tests of the small textures that an edit writes while it runs.
#include "item3d/core/files.h"
#include "item3d/core/progress_file.h"
#include "tests/support/edit.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::EditTest;

TEST_F(EditTest, ShowsItsTexturesWhileItRuns) {
    EditRequest edit = request("out", 3, {{"learning_rate", 0.05}});
    edit.live = folder_ / "live";
    fs::create_directories(edit.live);
    show_progress_in((folder_ / "progress.json").string());
    edit_model(edit);
    show_progress_in("");

    const auto live = nlohmann::json::parse(read_text(edit.live / "textures.json"));
    EXPECT_GE(live["revision"], 1);
    EXPECT_EQ(live["direction"].size(), 3u);
    ASSERT_EQ(live["textures"].size(), 2u);
    EXPECT_EQ(live["textures"][0]["material"], 0);
    EXPECT_EQ(live["textures"][0]["slot"], "base_color");
    const Image shown = load_image(edit.live / live["textures"][0]["file"].get<std::string>());
    const Image baked = base_color_of(edit.output / "model.glb");
    EXPECT_LT(mean_difference(shown, baked), 0.02) << "the last look is the result";
    EXPECT_GT(mean_difference(base_color_of(edit.model), baked), 0.02) << "which is another";

    const auto progress = nlohmann::json::parse(read_text(folder_ / "progress.json"));
    EXPECT_EQ(progress["stage"], "report");
}

TEST_F(EditTest, GoesOnWhereLiveTexturesCannotBeWritten) {
    EditRequest edit = request("out", 1);
    edit.live = folder_ / "nowhere";
    edit_model(edit);
    EXPECT_TRUE(fs::exists(edit.output / "model.glb"));
}

}  // namespace
}  // namespace item3d
