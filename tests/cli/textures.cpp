// Tests of missing textures: warnings, search folders, and the permission to do without.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

/// Fixture: a quad whose base colour names an image that does not exist.
class TexturesProgram : public EditProgram {
  protected:
    void SetUp() override {
        EditProgram::SetUp();
        quad_ = folder_ / "model" / "quad.obj";
        images_ = folder_ / "pictures";
        fs::create_directories(folder_ / "model");
        fs::create_directories(images_);
        std::ofstream(quad_) << "mtllib quad.mtl\nusemtl wall\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
        std::ofstream(folder_ / "model" / "quad.mtl")
            << "newmtl wall\nKd 1 1 1\nmap_Kd C:\\work\\brick.png\n";
        const Result drawn = run("render " + quoted(cube_) + " --size 16x16 --background red -o " +
                                 quoted(images_ / "brick.png"));
        EXPECT_EQ(drawn.code, 0) << drawn.error;
    }
    std::string edit_quad(const std::string& name, const std::string& rest = "") const {
        return "edit " + quoted(quad_) + " --prior '" + prior() +
               "' --resolution 32 --batch 1 --iterations 1 --texture-size 16 --image-size 32 "
               "--quiet " +
               to(name) + " " + rest;
    }
    std::string allowed() const { return " --textures " + quoted(images_); }

    fs::path quad_, images_;
};

TEST_F(TexturesProgram, AnEditAsksBeforeItGoesOnWithoutOne) {
    expect_error(edit_quad("out"), 3, "--allow-missing-textures");
    EXPECT_FALSE(fs::exists(folder_ / "out" / "model.glb"));

    const Result without = run(edit_quad("without", "--allow-missing-textures"));
    EXPECT_EQ(without.code, 0) << without.error;
    EXPECT_NE(without.error.find("brick.png"), std::string::npos) << without.error;
    EXPECT_TRUE(fs::exists(folder_ / "without" / "model.glb"));
}

TEST_F(TexturesProgram, OtherCommandsWarnAndDrawTheFactor) {
    const std::string draw =
        "render " + quoted(quad_) + small_light() + " --size 32x32 --quiet -o ";
    const Result plain = run(draw + quoted(folder_ / "plain.png"));
    EXPECT_EQ(plain.code, 0) << plain.error;
    EXPECT_NE(plain.error.find("warning"), std::string::npos) << plain.error;
    EXPECT_NE(plain.error.find("brick.png"), std::string::npos) << plain.error;
    const Result found = run(draw + quoted(folder_ / "found.png") + allowed());
    EXPECT_EQ(found.error, "");
    EXPECT_NE(read_file(folder_ / "plain.png"), read_file(folder_ / "found.png"));

    for (const std::string& command :
         {"relight " + quoted(quad_) + " --size 32 --views 1 --frames 1 --quiet -o " +
              quoted(folder_ / "relit"),
          "score " + quoted(quad_) + " " + quoted(quad_) +
              " --from 'a red wall' --to 'a blue wall' --views 1 --quiet",
          "caption " + quoted(quad_) + " --views 1 --quiet"}) {
        const Result allowing = run(command + small_light() + allowed());
        EXPECT_EQ(allowing.code, 0) << allowing.error;
        EXPECT_EQ(allowing.error.find("brick.png"), std::string::npos) << allowing.error;
    }
}

}  // namespace
}  // namespace item3d::testing
