// Tests of cases from JSON and CSV, and of refusals.
#include "item3d/compare/cases.h"
#include "item3d/compare/runs.h"
#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/seeds.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(Csv, QuotedFieldsComeBack) {
    const std::vector<std::string> fields = {"a", "b,c", "say \"hi\"", "two\nlines", ""};
    EXPECT_EQ(parse_csv(csv_line(fields) + "\n" + csv_line({"x"}), "t"), (CsvRows{fields, {"x"}}));
    EXPECT_EQ(parse_csv("\xef\xbb\xbf"
                        "a,b\r\n1,2\r\n",
                        "t"),
              (CsvRows{{"a", "b"}, {"1", "2"}}));
    EXPECT_THROW(parse_csv("a,\"b\n", "t"), InputError);
}

class CompareCases : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_compare_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
        write_atomically(folder_ / "cube.obj",
                         std::string_view("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"));
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::vector<CompareCase> read(const std::string& name, const std::string& text) const {
        write_atomically(folder_ / name, std::string_view(text));
        return read_compare_cases(folder_ / name);
    }
    void expect_refused(const std::string& name, const std::string& text,
                        const std::string& words) const {
        try {
            read(name, text);
            ADD_FAILURE() << "not refused: " << text;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
    fs::path folder_;
};

TEST_F(CompareCases, JsonAndCsvSayTheSame) {
    const auto a = read("a.json", R"([{"model": "cube.obj", "from": "a red cube",
        "to": "a blue cube, shining", "texture_size": 64, "instruction": "make it blue"}])");
    const auto b = read("b.csv",
                        "model,from,to,texture-size,instruction,light\n"
                        "cube.obj,a red cube,\"a blue cube, shining\",64,make it blue,\n");
    ASSERT_EQ(a.size(), 1u);
    ASSERT_EQ(b.size(), 1u);
    EXPECT_EQ(a[0].name, "cube: a blue cube, shining");
    EXPECT_EQ(a[0].name, b[0].name);
    EXPECT_EQ(a[0].to, b[0].to);
    EXPECT_EQ(option_arguments(a[0].options), option_arguments(b[0].options));
    EXPECT_EQ(option_arguments(a[0].options),
              (std::vector<std::string>{"--instruction", "make it blue", "--texture-size", "64"}));
}

TEST_F(CompareCases, ListsAreRepeatedOrHaveCommas) {
    EXPECT_EQ(option_arguments({{"region", {"named=a", "named=b"}},
                                {"timesteps", {0.1, 0.9}},
                                {"allow-missing-textures", true}}),
              (std::vector<std::string>{"--allow-missing-textures", "--region", "named=a",
                                        "--region", "named=b", "--timesteps", "0.1,0.9"}));
}

TEST_F(CompareCases, WhatIsWrongIsNamed) {
    expect_refused("a.json", "{", "is not valid JSON");
    expect_refused("a.json", "[]", "a list of cases");
    expect_refused("a.json", R"([{"from": "a", "to": "b"}])", "case 1: has no model");
    expect_refused("a.json", R"([{"model": "cube.obj", "from": "a"}])", "has no 'to'");
    expect_refused("a.json", R"([{"model": "no.obj", "from": "a", "to": "b"}])", "no such model");
    expect_refused("a.csv", "model,from,to,instuction\ncube.obj,a,b,c\n",
                   "did you mean 'instruction'");
    expect_refused("a.csv", "model,from,to\ncube.obj,a,b,c\n", "4 fields, but the header has 3");
    const auto with = [](const std::string& more) {
        return R"([{"model": "cube.obj", "from": "a", "to": "b", )" + more + "}]";
    };
    expect_refused("a.json", with(R"("variant": 3)"), "case 1: variant cannot be 3");
    expect_refused("a.json", with(R"("variant": ["a"])"), "variant cannot be");
    expect_refused("a.json", with(R"("textures": ["a", 4])"), "textures cannot be 4");
    expect_refused("a.csv", "model,from,to,method\ncube.obj,a,b,sds\n", "--methods");
}

TEST_F(CompareCases, AnOptionForAllGoesBeforeTheirOwn) {
    auto cases = read("a.csv", "model,from,to,iterations\ncube.obj,a,b,9\ncube.obj,a,c,\n");
    set_option(cases, "iterations=3");
    for (const CompareCase& test : cases)
        EXPECT_EQ(option_arguments(test.options), (std::vector<std::string>{"--iterations", "3"}));
    EXPECT_THROW(set_option(cases, "iterations"), UsageError);
    EXPECT_THROW(set_option(cases, "model=cube.obj"), UsageError);
    EXPECT_THROW(set_option(cases, "iteratoins=3"), InputError);
}

class CompareRuns : public CompareCases {
  protected:
    CompareOptions options() const {
        CompareOptions options;
        options.cases.resize(1);
        options.cases[0] = {"cube", folder_ / "cube.obj", "a red cube", "a blue cube", "", {}};
        options.cases[0].options = {{"instruction", "make it blue"}, {"batch", 1}};
        options.methods = {plain_method("item3d"), plain_method("in2n")};
        options.priors = {{"small", folder_ / "prior"}};
        options.seeds = {0, 1};
        options.output = folder_ / "out";
        return options;
    }
};

TEST_F(CompareRuns, FoldersAreNamedByContent) {
    const CompareOptions one = options();
    const auto runs = plan_runs(one);
    ASSERT_EQ(runs.size(), 4u);
    CompareOptions other = one;
    other.output = folder_ / "elsewhere";
    EXPECT_EQ(plan_runs(other)[0].folder.filename(), runs[0].folder.filename());
    other.cases[0].options["batch"] = 2;
    EXPECT_NE(plan_runs(other)[0].folder.filename(), runs[0].folder.filename());
    write_atomically(folder_ / "cube.obj",
                     std::string_view("v 0 0 0\nv 2 0 0\nv 1 1 0\nf 1 2 3\n"));
    EXPECT_NE(plan_runs(one)[0].folder.filename(), runs[0].folder.filename());
}

TEST_F(CompareRuns, OptionsOfOneMethodGoToItAlone) {
    for (const CompareRun& run : plan_runs(options())) {
        const bool has = std::find(run.arguments.begin(), run.arguments.end(), "--instruction") !=
                         run.arguments.end();
        EXPECT_EQ(has, run.method == "in2n");
    }
    CompareOptions twice = options();
    twice.cases.push_back(twice.cases[0]);
    EXPECT_THROW(plan_runs(twice), InputError);
}

TEST_F(CompareRuns, OptionsOfAMethodGoBeforeThoseOfACase) {
    CompareOptions given = options();
    given.cases[0].options["iterations"] = 9;
    given.methods = {{"fast", {{"iterations", 3}, {"guidance", "dds"}}}};
    const CompareRun run = plan_runs(given)[0];
    const auto value_of = [&](const char* option) {
        const auto at = std::find(run.arguments.begin(), run.arguments.end(), option);
        return at == run.arguments.end() ? "" : *(at + 1);
    };
    EXPECT_EQ(run.method, "fast");
    EXPECT_EQ(value_of("--method"), "item3d");
    EXPECT_EQ(value_of("--iterations"), "3");
    EXPECT_EQ(value_of("--guidance"), "dds");
    EXPECT_EQ(value_of("--batch"), "1");
}

TEST_F(CompareRuns, TheWholeSurfaceIsEditedUnlessACaseSaysOtherwise) {
    const auto region_of = [](const CompareRun& run) {
        const auto at = std::find(run.arguments.begin(), run.arguments.end(), "--region");
        return at == run.arguments.end() ? "" : *(at + 1);
    };
    CompareOptions given = options();
    EXPECT_EQ(region_of(plan_runs(given)[0]), "all");
    given.cases[0].options["region"] = "named=red";
    EXPECT_EQ(region_of(plan_runs(given)[0]), "named=red");
}

TEST(CompareSeeds, RangesAndLists) {
    EXPECT_EQ(parse_seeds("0..2"), (std::vector<std::uint64_t>{0, 1, 2}));
    EXPECT_EQ(parse_seeds("7,3"), (std::vector<std::uint64_t>{7, 3}));
    for (const char* wrong : {"", "a", "3..1", "1,", "0..100000", "-1"})
        EXPECT_THROW(parse_seeds(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace item3d
