// Tests of cases from JSON and CSV, and of refusals.
#include "item3d/compare/cases.h"
#include "item3d/compare/check_cases.h"
#include "item3d/compare/measures.h"
#include "item3d/compare/other_methods.h"
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

TEST_F(CompareCases, RepetitionsAreRefused) {
    expect_refused("a.csv", "name,model,from,to\nx,cube.obj,a,b\ny,cube.obj,a,c\nx,cube.obj,a,d\n",
                   "cases 1 and 3 are both named 'x'");
    expect_refused("a.csv", "model,from,to,texture_size,texture-size\ncube.obj,a,b,64,32\n",
                   "columns 4 and 5 are both 'texture-size'");
    expect_refused("a.json", R"([{"model": "cube.obj", "from": "a", "to": "b"},
                                 {"model": "cube.obj", "from": "a", "to": "b", "to": "c"}])",
                   "case 2: gives 'to' twice");
    expect_refused("a.csv", "model,from,to\ncube.obj,a,b\ncube.obj,a,b\n",
                   "cases 1 and 2 are the same");
    const auto cases = read("a.csv", "model,from,to,cfg\ncube.obj,a,b,1\ncube.obj,a,b,2\n");
    EXPECT_EQ(cases[0].name, "cube: b");
    EXPECT_EQ(cases[1].name, "cube: b (2)");
}

TEST_F(CompareCases, EmptyAndBrokenFilesAreNamed) {
    expect_refused("a.csv", "", "is empty");
    expect_refused("a.csv", "model,from,to\n", "has no rows");
    expect_refused("a.json", " \n", "is empty");
    expect_refused("a.json", "[{\"model\": \"r\xe9\"}]", "is not UTF-8");
    expect_refused("a.json", "[\n{\"model\" 3}]", "is not valid JSON: line 2, column ");
}

TEST_F(CompareCases, OnlySimilarNamesAreSuggested) {
    const std::string text = "model,from,to,COLUMN\ncube.obj,a,b,c\n";
    const auto message = [&](const std::string& column) -> std::string {
        try {
            read("a.csv", std::string(text).replace(text.find("COLUMN"), 6, column));
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message("nam").find("did you mean 'name'"), std::string::npos) << message("nam");
    EXPECT_EQ(message("colour").find("did you mean"), std::string::npos) << message("colour");
    EXPECT_NE(message("colour").find("name, model, from, to, expect"), std::string::npos);
}

TEST_F(CompareCases, AnOptionForAllIsADefault) {
    auto cases = read("a.csv", "model,from,to,iterations\ncube.obj,a,b,9\ncube.obj,a,c,\n");
    set_defaults(cases, {"iterations=3", "batch=1"});
    EXPECT_EQ(option_arguments(cases[0].options),
              (std::vector<std::string>{"--batch", "1", "--iterations", "9"}));
    EXPECT_EQ(option_arguments(cases[1].options),
              (std::vector<std::string>{"--batch", "1", "--iterations", "3"}));
    for (const char* wrong : {"iterations", "model=cube.obj", "iteratoins=3", "seed=3"})
        EXPECT_THROW(set_defaults(cases, {wrong}), UsageError) << wrong;
    EXPECT_THROW(set_defaults(cases, {"cfg=1", "cfg=2"}), UsageError);
    // Bad values are refused even if every case overrides them.
    cases.erase(cases.begin() + 1);
    for (const char* wrong : {"iterations=x", "iterations=-1", "clip-loss=none"})
        EXPECT_THROW(set_defaults(cases, {wrong}), InputError) << wrong;
    try {
        set_defaults(cases, {"iteratoins=3"});
    } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()).find("column"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("'iterations'"), std::string::npos);
    }
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

TEST_F(CompareRuns, BadValuesAreFoundBeforeAnyRun) {
    const auto refused = [&](const std::string& option, const json& value) {
        CompareOptions given = options();
        given.cases[0].options[option] = value;
        EXPECT_THROW(check_cases(given), InputError) << option << " " << value;
    };
    EXPECT_NO_THROW(check_cases(options()));
    refused("iterations", "many");
    refused("iterations", -1);
    refused("batch", 1.5);
    refused("timesteps", "0.9,0.1");
    refused("guidance", "zork");
    refused("clip-loss", "zork");
    refused("keep", "colour");
    refused("light", "moon");
    refused("instruct", (folder_ / "none").string());
    refused("region", "namd=red");
    refused("image-size", 4);
    refused("precision", "fp7");
    CompareOptions kept = options();
    kept.cases[0].options.update({{"keep", "nothing"}, {"light", "noon"}, {"region", "all"}});
    kept.cases[0].options.update({{"timesteps", {0.1, 0.9}}, {"iterations", "20"}});
    EXPECT_NO_THROW(check_cases(kept));
}

TEST_F(CompareRuns, TheWordToExpectIsOfThePrior) {
    CompareOptions given = options();
    given.priors = {{"embedded", assets_folder() / "prior"}};
    given.cases[0].given_model = "cube.obj";
    given.cases[0].expect = "golde";
    try {
        check_cases(given);
        ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("did you mean 'gold"), std::string::npos)
            << error.what();
    }
    given.cases[0].expect = "gold";
    EXPECT_NO_THROW(check_cases(given));
}

TEST_F(CompareRuns, FinishedRunsOfOtherMethodsAreNamed) {
    const CompareOptions all = options();
    for (const CompareRun& run : plan_runs(all)) {
        fs::create_directories(run.folder);
        write_atomically(run.folder / "edit.json", std::string_view("{}"));
    }
    EXPECT_TRUE(other_methods(all).empty());
    CompareOptions fewer = all;
    fewer.methods = {plain_method("in2n")};
    EXPECT_EQ(other_methods(fewer), std::vector<std::string>{"item3d"});
}

TEST_F(CompareRuns, RowsNameTheModelAsGivenAndTheOptions) {
    CompareOptions given = options();
    given.cases[0].given_model = "models/../cube.obj";
    const json row = row_of(plan_runs(given)[0], given.cases[0]);
    EXPECT_EQ(row.at("model"), "models/../cube.obj");
    EXPECT_EQ(row.at("options"), given.cases[0].options);
}

TEST(CompareSeeds, WhatIsWrongIsSaid) {
    const auto message = [](const std::string& text) -> std::string {
        try {
            parse_seeds(text);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message("3..1").find("smaller than the first; write 1..3"), std::string::npos);
    EXPECT_NE(message("0..1000").find("more than 1000"), std::string::npos);
    EXPECT_NE(message("").find("is empty"), std::string::npos);
    EXPECT_EQ(message("0..999"), "");
}

TEST(CompareSeeds, RangesAndLists) {
    EXPECT_EQ(parse_seeds("0..2"), (std::vector<std::uint64_t>{0, 1, 2}));
    EXPECT_EQ(parse_seeds("7,3"), (std::vector<std::uint64_t>{7, 3}));
    for (const char* wrong : {"", "a", "3..1", "1,", "0..100000", "-1"})
        EXPECT_THROW(parse_seeds(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace item3d
