// Tests of item3d compare on the command line: partial failure, resuming, and refusals.
#include "tests/support/program.h"

namespace item3d::testing {
namespace {

class CompareProgram : public EditProgram {
  protected:
    void SetUp() override {
        EditProgram::SetUp();
        write("cases.json",
              R"([{"model": "cube.obj", "from": "a red cube", "to": "a blue cube",
                   "resolution": 32, "batch": 1, "iterations": 2, "texture_size": 64,
                   "image-size": 32, "light": ")" +
                  (folder_ / "small.hdr").string() + "\"}]");
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }
    std::string compare(const std::string& cases, const std::string& rest = "") const {
        return "compare " + quoted(folder_ / cases) + " --prior '" + prior() + "' -o " +
               quoted(folder_ / "out") + " " + rest;
    }
};

TEST_F(CompareProgram, OneFailureDoesNotEndTheRest) {
    const std::string command = compare("cases.json", "--methods in2n,sds --json");
    const Result first = run(command);
    ASSERT_EQ(first.code, 3) << first.error;
    EXPECT_NE(first.error.find("1 of 2 runs failed"), std::string::npos) << first.error;
    EXPECT_NE(first.error.find("(1 of 2)"), std::string::npos) << first.error;
    EXPECT_NE(first.out.find("\"failed\": 1"), std::string::npos) << first.out;
    EXPECT_NE(first.out.find("is not an InstructPix2Pix"), std::string::npos) << first.out;
    for (const char* key : {"detail_kept", "geometry_kept", "view_difference", "light_baked"})
        EXPECT_NE(first.out.find(key), std::string::npos) << key;
    for (const char* file : {"table.csv", "table.tex", "index.html"})
        EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    const std::string table = read_file(folder_ / "out" / "table.csv");
    const Result again = run(command);
    EXPECT_NE(again.error.find("1 of 2 runs already exist"), std::string::npos) << again.error;
    EXPECT_EQ(read_file(folder_ / "out" / "table.csv"), table);
}

TEST_F(CompareProgram, TableOnlyHasTheFinishedRuns) {
    expect_error(compare("cases.json", "--methods sds --table-only"), 3,
                 "none of its runs has finished");
    ASSERT_EQ(run(compare("cases.json", "--methods sds")).code, 0);
    const Result part = run(compare("cases.json", "--methods sds,texture --table-only --json"));
    EXPECT_EQ(part.code, 0) << part.error;
    EXPECT_NE(part.out.find("\"runs\": 1"), std::string::npos) << part.out;
    EXPECT_NE(part.error.find("1 of 2 runs have finished"), std::string::npos) << part.error;
}

TEST_F(CompareProgram, WhatCannotBeComparedIsNamed) {
    write("none.json", R"([{"from": "a", "to": "b"}])");
    expect_error(compare("none.json"), 3, "case 1: has no model");
    write("typo.csv", "model,from,to,litgh\ncube.obj,a,b,noon\n");
    expect_error(compare("typo.csv"), 3, "did you mean 'light'");
    expect_error(compare("missing.json"), 3, "missing.json");
    expect_error(compare("cases.json", "--methods best"), 3, "unknown method 'best'");
    expect_error(compare("cases.json", "--suite best"), 3, "unknown suite 'best'");
    expect_error(compare("cases.json", "--seeds 3..1"), 2, "--seeds 3..1");
    expect_error(compare("cases.json", "--rows 9"), 2, "--rows requires --suite guidance");
    expect_error(compare("cases.json", "--suite quality --mesh cow=cow.obj"), 2,
                 "--mesh is for the cases of a suite");
    expect_error(compare("cases.json", "--with iterations=x"), 3, "iterations cannot be \"x\"");
    write("late.csv", "model,from,to,cfg\ncube.obj,a,b,1\ncube.obj,a,c,high\n");
    expect_error(compare("late.csv"), 3, "case 2 ('cube: c'): cfg cannot be \"high\"");
    EXPECT_FALSE(fs::exists(folder_ / "out" / "runs"));
}

}  // namespace
}  // namespace item3d::testing
