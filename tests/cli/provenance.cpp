// Tests of item3d variants, item3d provenance and --sign-key on the command line.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

class ProvenanceProgram : public EditProgram {
  protected:
    void SetUp() override {
        EditProgram::SetUp();
        // Key pairs of RFC 8032, 7.1, tests 1 and 2.
        write("key.pem",
              "-----BEGIN PRIVATE KEY-----\n"
              "MC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
              "-----END PRIVATE KEY-----\n");
        write("public.pem",
              "-----BEGIN PUBLIC KEY-----\n"
              "MCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n"
              "-----END PUBLIC KEY-----\n");
        write("other.pem",
              "-----BEGIN PUBLIC KEY-----\n"
              "MCowBQYDK2VwAyEAPUAXw+hDiVqStwqnTRt+vJyYLM8uxJaMwM1V8Sr0Zgw=\n"
              "-----END PUBLIC KEY-----\n");
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    std::string file(const std::string& name) const { return quoted(folder_ / name); }
};

TEST_F(ProvenanceProgram, AnEditIsSignedAndVerified) {
    const std::string signed_edit = edit(to("out")) + " --sign-key " + file("key.pem");
    expect_error(edit(to("out")) + " --sign-key " + file("public.pem"), 3, "is a public key");
    expect_error(signed_edit + " --provenance off", 2, "--provenance off");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    ASSERT_EQ(run(signed_edit).code, 0);
    const Result said = run("provenance " + file("out/model.glb"));
    EXPECT_EQ(said.code, 0) << said.error;
    for (const char* words :
         {"compositeWithTrainedAlgorithmicMedia", "\"a red cube\"", "\"a blue cube\"",
          "pipeline_sd", "2023-11-14T22:13:20Z", "as it was written", "11qYAYKxCrfVS"})
        EXPECT_NE(said.out.find(words), std::string::npos) << words << "\n" << said.out;
    const std::string verify = "provenance " + file("out/model.glb") + " --public-key ";
    EXPECT_EQ(run(verify + file("public.pem") + " --json").code, 0);
    expect_error(verify + file("other.pem"), 6, "another key");
    expect_error(verify + file("missing.pem"), 3, "missing.pem");
    // A layer reproduces the edit together with its signature.
    ASSERT_EQ(run("layers " + quoted(cube_) + " " + file("out") + " --sign-key " + file("key.pem") +
                  " -o " + file("again.glb"))
                  .code,
              0);
    EXPECT_EQ(read_file(folder_ / "again.glb"), read_file(folder_ / "out/model.glb"));
    std::string forged = read_file(folder_ / "out/model.glb");
    forged[forged.find("a blue cube")] = 'A';
    write("forged.glb", forged);
    expect_error("provenance " + file("forged.glb"), 5, "was altered");
    expect_error("provenance " + quoted(cube_), 3, "is neither a glTF nor an image");
    for (const auto& texture : fs::directory_iterator(folder_ / "out/textures"))
        EXPECT_EQ(
            run("provenance " + quoted(texture.path()) + " --public-key " + file("public.pem"))
                .code,
            0);
}

TEST_F(ProvenanceProgram, EditsBecomeVariantsAndSilentOnesSayNothing) {
    ASSERT_EQ(run(edit(to("one"))).code, 0);
    ASSERT_EQ(run(edit(to("two") + " --seed 3 --provenance off")).code, 0);
    EXPECT_NE(run("provenance " + file("two/model.glb")).out.find("no claim"), std::string::npos);
    expect_error("provenance " + file("two/model.glb") + " --public-key " + file("public.pem"), 7,
                 "is not signed");
    const std::string variants = "variants " + quoted(cube_) + " " + file("one") + " ";
    const Result made = run(variants + file("two") + " -o " + file("shop.glb"));
    EXPECT_EQ(made.code, 0) << made.error;
    EXPECT_EQ(made.out, "original\nblue cube\nblue cube 2\n");
    EXPECT_EQ(run("provenance " + file("shop.glb")).code, 0);
    EXPECT_EQ(run("render " + file("shop.glb") + small_light() +
                  "--size 16 --variant 'blue cube 2' -o " + file("two.png"))
                  .code,
              0);
    expect_error(variants + "-o " + file("shop.glb") + " --name a --name b", 3, "for 1 edits");
    expect_error(variants + folder_.string() + " -o " + file("no.glb"), 3, "has no edit.json");
    std::ofstream(cube_, std::ios::app) << "# changed\n";
    expect_error(variants + "-o " + file("no.glb"), 3, "a different model");
    EXPECT_FALSE(fs::exists(folder_ / "no.glb"));
}

}  // namespace
}  // namespace item3d::testing
