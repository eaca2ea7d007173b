#include "tests/support/program.h"

#include <nlohmann/json.hpp>

namespace item3d::testing {
namespace {

/// Fixture of item3d generate with priors of random weights, small enough for a test.
class GenerateProgram : public Program {
  protected:
    std::string generate(const std::string& prior, const std::string& rest,
                         const std::string& size = "32x16", int steps = 2) const {
        return "generate 'a red mug' --prior '" ITEM3D_TEST_DATA "/models/" + prior + "' --steps " +
               std::to_string(steps) + " --size " + size + " --threads 1 --json -o " +
               quoted(folder_ / "p.png") + " " + rest;
    }
};

TEST_F(GenerateProgram, DrawsWithTheFoldersSchedulerOrAnother) {
    for (const auto& [prior, own] :
         {std::pair{"pipeline_sd", "ddim"}, std::pair{"pipeline_sdxl", "euler"}}) {
        const auto scheduler_of = [&](const std::string& arguments) {
            const Result result = run(arguments);
            EXPECT_EQ(result.code, 0) << result.error;
            const auto record = nlohmann::json::parse(result.out, nullptr, false);
            return record.is_object() ? record["scheduler"].get<std::string>() : "";
        };
        EXPECT_EQ(scheduler_of(generate(prior, "")), own);
        const std::string first = read_file(folder_ / "p.png");
        EXPECT_EQ(scheduler_of(generate(prior, "--scheduler dpmpp-2m-karras")), "dpmpp-2m-karras");
        EXPECT_NE(read_file(folder_ / "p.png"), first);
    }
}

TEST_F(GenerateProgram, TheEmbeddedPriorTakesAShapeOfItsOwnForAThingThatItKnows) {
    const auto shape_of = [&](const std::string& prompt, const std::string& rest) {
        const Result result = run("generate '" + prompt + "' --steps 2 --json -o " +
                                  quoted(folder_ / "p.png") + " " + rest);
        EXPECT_EQ(result.code, 0) << result.error;
        const auto record = nlohmann::json::parse(result.out, nullptr, false);
        const std::string shape = record.is_object() ? record.value("own_shape", "?") : "?";
        EXPECT_EQ(result.error.find("--like none") == std::string::npos, shape.empty());
        return shape;
    };
    EXPECT_EQ(shape_of("a golden chair", "--count 2"), "chair");
    const std::string first = read_file(folder_ / "p_000.png");
    EXPECT_NE(first, read_file(folder_ / "p_001.png"));
    EXPECT_EQ(shape_of("a golden chair", ""), "chair");
    EXPECT_EQ(read_file(folder_ / "p.png"), first) << "it depends on the count";
    EXPECT_EQ(shape_of("a golden chair", "--like none"), "");
    EXPECT_NE(read_file(folder_ / "p.png"), first);
    EXPECT_EQ(shape_of("a golden object", ""), "");
    EXPECT_EQ(shape_of("a golden chair", "--like " + quoted(cube_)), "");
    EXPECT_EQ(
        shape_of("a red mug", "--size 32x16 --prior '" ITEM3D_TEST_DATA "/models/pipeline_sd'"),
        "");
}

TEST_F(GenerateProgram, SeveralImagesGetASheet) {
    EXPECT_EQ(run(generate("pipeline_sd", "--count 3")).code, 0);
    EXPECT_TRUE(fs::exists(folder_ / "p.png"));
    for (const char* name : {"p_000.png", "p_001.png", "p_002.png"})
        EXPECT_TRUE(fs::exists(folder_ / name)) << name;
    const std::string second = read_file(folder_ / "p_001.png");
    EXPECT_NE(second, read_file(folder_ / "p_000.png"));
    EXPECT_EQ(run(generate("pipeline_sd", "--count 2")).code, 0);
    EXPECT_EQ(read_file(folder_ / "p_001.png"), second) << "it depends on the count";
}

TEST_F(GenerateProgram, NamesItsSchedulersAndRefusesOthers) {
    const Result help = run("generate --help");
    for (const char* name : {"ddim", "ddpm", "euler-karras", "dpmpp-2m", "pndm"})
        EXPECT_NE(help.out.find(name), std::string::npos) << name;
    EXPECT_EQ(run(generate("pipeline_sd", "--scheduler heun")).code, 2);
    expect_error(generate("pipeline_sd", "", "33x16"), 3, "33x16");
    expect_error(generate("pipeline_sd", "--scheduler dpmpp-2m", "32x16", 1000), 3, "1000 steps");
}

}  // namespace
}  // namespace item3d::testing
