// Tests of item3d bench: its output contains all numbers, and they are times.
#include "tests/support/program.h"

#include <nlohmann/json.hpp>

namespace item3d::testing {
namespace {

using nlohmann::json;

void expect_time(const json& object, const char* name) {
    ASSERT_TRUE(object.contains(name)) << name;
    ASSERT_TRUE(object[name].is_number()) << name;
    EXPECT_GT(object[name].get<double>(), 0) << name;
    EXPECT_LT(object[name].get<double>(), 60000) << name;
}

TEST_F(Program, BenchRenderGivesTheTimeOfEachStage) {
    const Result result = run("bench render --model " + quoted(cube_) +
                              " --size 48x32 --repeats 2 --threads 1 --device cpu --quiet --json");
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.error, "");
    const json found = json::parse(result.out);
    for (const char* name :
         {"forward_ms", "forward_backward_ms", "neural_forward_ms", "neural_forward_backward_ms"})
        expect_time(found, name);
    EXPECT_EQ(found["width"], 48);
    EXPECT_EQ(found["height"], 32);
    EXPECT_EQ(found["threads"], 1);
    EXPECT_EQ(found["triangles"], 2);
    EXPECT_EQ(found["device"], "cpu");
    EXPECT_GT(found["covered_pixels"].get<int>(), 100);
    std::string stages;
    for (const json& stage : found["stages"]) {
        expect_time(stage, "forward_ms");
        expect_time(stage, "backward_ms");
        stages += stage["stage"].get<std::string>() + ";";
    }
    for (const char* name : {"rasterise", "interpolate", "sample textures", "neural texture",
                             "shade", "scatter and antialias"})
        EXPECT_NE(stages.find(name), std::string::npos) << name;
    ASSERT_EQ(found["prefilter"].size(), 1u);
    expect_time(found["prefilter"][0], "forward_ms");
    expect_time(found["prefilter"][0], "backward_ms");
    EXPECT_EQ(found["rows"].size(), 1u);
}

TEST_F(Program, BenchRenderPrintsATableForEachSize) {
    const Result result = run("bench render --model " + quoted(cube_) +
                              " --size 16 24x8 --repeats 1 --device cpu --quiet");
    ASSERT_EQ(result.code, 0) << result.error;
    for (const char* text : {"16 x 16", "24 x 8", "shade", "prefilter"})
        EXPECT_NE(result.out.find(text), std::string::npos) << text << "\n" << result.out;
}

TEST_F(Program, BenchRefusesWhatItCannotMeasure) {
    EXPECT_EQ(run("bench").code, 2);
    EXPECT_EQ(run("bench render --size 0x4 --model " + quoted(cube_)).code, 2);
    EXPECT_EQ(run("bench render --repeats 0 --model " + quoted(cube_)).code, 2);
    expect_error("bench render --model /nowhere.glb", 3, "/nowhere.glb");
}

}  // namespace
}  // namespace item3d::testing
