// Tests of item3d layers on the command line: refusals and help.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

TEST_F(Program, LayersThatCannotBeAppliedAreNamed) {
    const std::string to = " -o " + quoted(folder_ / "out.glb");
    const fs::path file = folder_ / "layer.safetensors";
    const std::string layers = "layers " + quoted(cube_) + " ";
    expect_error(layers + quoted(file) + to, 3, "layer.safetensors");
    const std::string header = R"({"__metadata__":{"format":"pt"}})";
    std::ofstream(file, std::ios::binary)
        << static_cast<char>(header.size()) << std::string(7, '\0') << header;
    expect_error(layers + quoted(file) + to, 3, "is not a layer of an edit");
    expect_error(layers + quoted(file) + " -o " + quoted(cube_), 3, "is the input model");
    expect_error(layers + quoted(file) + ":nan" + to, 2, "invalid strength 'nan'");
    expect_error(layers + quoted(file) + ":1:colour" + to, 2, "unknown channel 'colour'");
    EXPECT_FALSE(fs::exists(folder_ / "out.glb"));
    std::ofstream(folder_ / "named.obj") << "mtllib first.mtl ./other.mtl\n" << read_file(cube_);
    std::ofstream(folder_ / "other.mtl") << "newmtl paint\n";
    expect_error("layers " + quoted(folder_ / "named.obj") + " " + quoted(file) + " -o " +
                     quoted(folder_ / "other.obj"),
                 3, "other.mtl: is used by the input model");
}

TEST_F(EditProgram, LayersGiveTheEditAgain) {
    ASSERT_EQ(run(edit(to("out"))).code, 0);
    const Result result = run("layers " + quoted(cube_) + " " + quoted(folder_ / "out") +
                              " --json -o " + quoted(folder_ / "new" / "again.glb"));
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_NE(result.out.find("a blue cube"), std::string::npos) << result.out;
    EXPECT_EQ(read_file(folder_ / "new" / "again.glb"), read_file(folder_ / "out" / "model.glb"));
    const Result small = run("layers " + quoted(cube_) + " " + quoted(folder_ / "out") +
                             " --texture-size 32 --json -o " + quoted(folder_ / "small.glb"));
    EXPECT_EQ(small.code, 0) << small.error;
    EXPECT_NE(small.out.find("baked_because"), std::string::npos) << small.out;
    EXPECT_NE(small.error.find("baked again from their neural fields"), std::string::npos)
        << small.error;
}

}  // namespace
}  // namespace item3d::testing
