// Tests of item3d region, and of edits of regions and by plans: outputs and error messages.
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

namespace item3d::testing {
namespace {

using nlohmann::json;

class RegionProgram : public EditProgram {
  protected:
    std::string region(const std::string& rest) const {
        return "region " + quoted(cube_) + " --size 32 --quiet -o " + quoted(folder_ / "region") +
               " " + rest;
    }
};

TEST_F(RegionProgram, ShowsWhatIsSelected) {
    const Result result = run(region("--region box=0,0,-1,0.5,1,1 --json"));
    ASSERT_EQ(result.code, 0) << result.error;
    const json record = json::parse(result.out);
    EXPECT_NEAR(record["share"].get<double>(), 0.5, 0.01);
    for (const char* file : {"region.png", "region.json", "transforms.json", "view_0.png"})
        EXPECT_TRUE(fs::exists(folder_ / "region" / file)) << file;
    // The view of a painted mask is given by a camera of its own.
    const std::string painted = "view=" + (folder_ / "white.png").string() + "@" +
                                (folder_ / "region" / "transforms.json").string() + "#view_3";
    ASSERT_EQ(run("render " + quoted(cube_) + " --size 32 --quiet --background white -o " +
                  quoted(folder_ / "white.png"))
                  .code,
              0);
    const Result view = run(region("--json --region '" + painted + "'"));
    EXPECT_EQ(view.code, 0) << view.error;
}

TEST_F(RegionProgram, MistakesAreThreeAndWriteNothing) {
    expect_error(region("--region handle"), 3, "choose from");
    expect_error(region("--region material=wood"), 3, "no material with a name");
    expect_error(region("--region sphere=0,0,9,1"), 3, "outside the model");
    expect_error(region("--region mask=/nowhere.png"), 3, "/nowhere.png");
    expect_error(region("--region 'words=the flux capacitor'"), 3, "does not know");
    expect_error(region("--region auto"), 2, "--from and --to");
    expect_error(region("--region auto --from 'a cube'"), 2, "--from and --to");
    expect_error(region("--region named=red --from a --to b"), 2, "--region auto");
    expect_error(region("--region auto --from 'a zorp' --to 'a qwix'"), 3, "as the same");
    EXPECT_FALSE(fs::exists(folder_ / "region"));
    EXPECT_EQ(run(region("--feather -1")).code, 2);
    expect_error(edit(to("out") + " --region named=Purple"), 3, "nothing of the edited materials");
    EXPECT_FALSE(fs::exists(folder_ / "out" / "model.glb"));
}

TEST_F(RegionProgram, PlansRunInOrderAndGoOn) {
    const fs::path plan = folder_ / "plan.json";
    std::ofstream(plan) << R"({"edits": [
        {"from": "a red cube", "to": "a blue cube", "region": "box=0,0,-1,0.5,1,1"},
        {"from": "a blue cube", "to": "a green cube", "iterations": 1}]})";
    const std::string line = edit("--plan " + quoted(plan) + " -o " + quoted(folder_ / "out"));
    const Result result = run(line);
    ASSERT_EQ(result.code, 0) << result.error;
    for (const char* file : {"1/model.glb", "2/model.glb", "model.glb", "report.html", "edit.json"})
        EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    EXPECT_EQ(read_file(folder_ / "out" / "model.glb"), read_file(folder_ / "out" / "2/model.glb"));
    const auto written = fs::last_write_time(folder_ / "out" / "1" / "model.glb");
    fs::remove(folder_ / "out" / "2" / "edit.json");
    const Result again = run(line + " --resume");
    ASSERT_EQ(again.code, 0) << again.error;
    EXPECT_EQ(fs::last_write_time(folder_ / "out" / "1" / "model.glb"), written);

    std::ofstream(plan) << R"({"edits": [{"from": "a red cube", "too": "a blue cube"}]})";
    expect_error(line, 3, "edit 1");
    // An invalid value is reported before the first edit.
    fs::remove_all(folder_ / "out");
    std::ofstream(plan) << R"({"edits": [{"from": "a red cube", "to": "a blue cube"},
        {"from": "a blue cube", "to": "a green cube", "feather": 90}]})";
    expect_error(line, 3, "--feather");
    std::ofstream(plan) << R"({"edits": [{"from": "a red cube", "to": "a blue cube"},
        {"from": "a blue cube", "to": "a green cube", "region": ["sphere=0,0,9,1"]}]})";
    expect_error(line, 3, "edit 2: sphere=0,0,9,1: is outside the model");
    std::ofstream(plan) << R"({"edits": [{"from": "a", "to": "b", "region": 3}]})";
    expect_error(line, 3, "edit 1: region cannot be 3");
    EXPECT_FALSE(fs::exists(folder_ / "out" / "1"));
    EXPECT_EQ(run(line + " --from a --to b").code, 2);
    std::ofstream(plan) << "[";
    expect_error(line, 3, "is not valid JSON, see line 1");
    EXPECT_EQ(run("edit " + quoted(cube_) + " -o " + quoted(folder_ / "none")).code, 2);
}

}  // namespace
}  // namespace item3d::testing
