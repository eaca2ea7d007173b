// Tests of item3d render --occlusion and --samples: defaults, and effects on hidden surfaces and
// edges.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

/// Fixture: a floor with a wall on it.
class RenderProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        corner_ = folder_ / "corner.obj";
        std::ofstream(corner_) << "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 1 0\nv 1 1 0\n"
                                  "f 1 4 3 2\nf 1 2 6 5\n";
    }
    std::string image(const std::string& name, const std::string& options) const {
        const fs::path path = folder_ / (name + ".exr");
        const Result result = run("render " + options + " " + quoted(corner_) + small_light() +
                                  " --size 32x32 --quiet -o " + quoted(path));
        EXPECT_EQ(result.code, 0) << result.error;
        EXPECT_EQ(result.error, "");
        return read_file(path);
    }
    fs::path corner_;
};

TEST_F(RenderProgram, ChangesTheImageOnlyWhereAsked) {
    const std::string plain = image("plain", "");
    const std::string ambient = image("ambient", "--occlusion");
    EXPECT_NE(ambient, plain);
    const std::string light = image("light", "--occlusion=light");
    EXPECT_NE(light, ambient);
    const std::string indirect = image("indirect", "--indirect");
    EXPECT_NE(indirect, light);
    EXPECT_EQ(image("same", "--indirect --occlusion=light --threads 3"), indirect);
}

TEST_F(RenderProgram, SamplesChangeEdgesAndFitTheSize) {
    const std::string usual = image("usual", "");
    EXPECT_EQ(image("two", "--samples 2"), usual);
    EXPECT_NE(image("four", "--samples 4"), usual);
    const Result result = run("render " + quoted(corner_) + " -o " + quoted(folder_ / "p.png") +
                              " --size 8192x2 --samples 3");
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find("at most 2"), std::string::npos) << result.error;
}

TEST_F(RenderProgram, LightOptionsAreNumbers) {
    const std::string rest = quoted(corner_) + " -o " + quoted(folder_ / "p.png");
    EXPECT_EQ(run("render --exposure nan " + rest).code, 2);
    EXPECT_EQ(run("render --light-rotation nan " + rest).code, 2);
}

TEST_F(RenderProgram, IsOfShadedImagesAlone) {
    const std::string rest = quoted(corner_) + " -o " + quoted(folder_ / "p.png");
    EXPECT_EQ(run("render --occlusion --channel depth " + rest).code, 2);
    EXPECT_EQ(run("render --occlusion=much " + rest).code, 2);
}

}  // namespace
}  // namespace item3d::testing
