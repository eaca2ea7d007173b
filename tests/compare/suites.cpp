// Tests of the built-in suites and the checks of their results.
#include "item3d/compare/suites.h"

#include "item3d/compare/verdict.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/edit/settings_table.h"
#include "item3d/guidance/guidance.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class CompareSuites : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_suites_" + std::to_string(::getpid()));
        prior_ = assets_folder() / "prior";
    }
    void TearDown() override { fs::remove_all(folder_); }
    static CompareSuite suite(const std::string& name, int rows = 700) {
        for (const CompareSuite& one : compare_suites(rows))
            if (one.name == name) return one;
        ADD_FAILURE() << name;
        return {};
    }
    fs::path folder_, prior_;
};

TEST_F(CompareSuites, OptionsAreThoseOfTheEdit) {
    std::set<std::string> flags;
    for (const Setting& setting : settings_table())
        flags.insert(setting.flag);
    for (const CompareSuite& one : compare_suites(700)) {
        std::set<std::string> names;
        for (const CompareMethod& method : one.methods) {
            EXPECT_TRUE(names.insert(method.name).second) << one.name << " " << method.name;
            for (const auto& [option, value] : method.options.items())
                EXPECT_TRUE(flags.contains("--" + option)) << one.name << " " << option;
        }
    }
}

TEST_F(CompareSuites, GuidanceSharesTheRows) {
    std::map<std::string, int> iterations;
    for (const CompareMethod& method : suite("guidance", 800).methods)
        iterations[method.name] = method.options.at("iterations").get<int>();
    EXPECT_EQ(iterations.at("sds"), 400);
    EXPECT_EQ(iterations.at("learned"), 160);
    EXPECT_EQ(iterations.at("sdi"), 50);
    EXPECT_EQ(suite("guidance", 1).methods.back().options.at("iterations"), 1);
}

TEST_F(CompareSuites, GuidanceHasAllMethods) {
    std::set<std::string> compared;
    for (const CompareMethod& method : suite("guidance").methods)
        compared.insert(method.options.at("guidance").get<std::string>());
    for (const std::string& method : guidance_methods())
        EXPECT_TRUE(compared.contains(method)) << method;
}

TEST_F(CompareSuites, CasesStartFromModelsThatAreThere) {
    for (const char* name : {"adjustment", "direction", "held-out"}) {
        const auto cases = cases_of_suite(suite(name), folder_, {});
        ASSERT_FALSE(cases.empty());
        std::set<std::string> names;
        for (const CompareCase& test : cases) {
            EXPECT_TRUE(fs::exists(test.model)) << test.model;
            EXPECT_TRUE(names.insert(test.name).second) << test.name;
            EXPECT_NE(test.from, test.to);
        }
        CompareOptions options;
        options.cases = cases;
        options.priors = {{"embedded", prior_}};
        EXPECT_NO_THROW(check_expectations(options));
    }
}

TEST_F(CompareSuites, HeldOutHasEighteenTargets) {
    std::map<std::string, int> models;
    std::set<std::string> targets;
    const auto cases = cases_of_suite(suite("held-out"), folder_, {});
    for (const CompareCase& test : cases) {
        targets.insert(test.expect);
        ++models[test.name.substr(0, test.name.find(':'))];
    }
    EXPECT_EQ(cases.size(), 18u);
    EXPECT_EQ(targets.size(), 18u);
    EXPECT_EQ(models.size(), 6u);
    for (const auto& [model, count] : models)
        EXPECT_EQ(count, 3) << model;
}

TEST_F(CompareSuites, ColoursAreJudgedByTheMean) {
    CompareCase test;
    test.to = "a golden rabbit";
    test.expect = "red";
    const auto verdict = [&](const json& color) {
        return verdict_of(test, {{"base_color_linear", color}}, at::Tensor(), prior_);
    };
    EXPECT_EQ(verdict({0.7, 0.03, 0.03}), (json{{"found", "red"}, {"right", true}}));
    EXPECT_EQ(verdict({0.02, 0.07, 0.62}), (json{{"found", "blue"}, {"right", false}}));
    test.expect = "";
    EXPECT_TRUE(verdict({0.7, 0.03, 0.03}).empty());
    CompareOptions options;
    test.expect = "reddish";
    options.cases = {test};
    options.priors = {{"embedded", prior_}};
    EXPECT_THROW(check_expectations(options), InputError);
}

}  // namespace
}  // namespace item3d
