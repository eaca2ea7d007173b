// Tests of the tables of a comparison, against sums by hand.
#include "item3d/compare/table.h"

#include "item3d/compare/page.h"
#include "item3d/compare/pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace item3d {
namespace {

using nlohmann::json;

json compared(const std::string& name, const std::string& method, int seed, double direction) {
    return {{"case", name},  {"model", "cube.obj"}, {"from", "a"},
            {"to", "b, c"},  {"method", method},    {"prior", "embedded"},
            {"seed", seed},  {"folder", "runs/x"},  {"clip_directional", direction},
            {"seconds", 10}, {"uv_kept", seed == 0}};
}

json broken(const std::string& name, const std::string& method) {
    json row = compared(name, method, 0, 0);
    for (const char* key : {"clip_directional", "seconds", "uv_kept"})
        row.erase(key);
    row["error"] = "needs <weights> & more";
    return row;
}

const std::vector<json> compared_rows = {
    compared("one", "item3d", 0, 0.5), compared("one", "item3d", 1, 0.7),
    compared("two", "item3d", 0, 0.1), broken("two", "in2n"), compared("one", "sds_x", 0, 0.2)};

TEST(CompareTable, MeansAndSpread) {
    const auto all = summarize(compared_rows);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].method, "item3d");
    EXPECT_NEAR(all[0].clip_directional.value(), 1.3 / 3, 1e-12);
    EXPECT_NEAR(all[0].uv_kept.value(), 2.0 / 3, 1e-12);
    EXPECT_NEAR(all[0].spread.value(), std::sqrt(0.02), 1e-12);
    EXPECT_FALSE(all[0].clip_global.has_value());
    EXPECT_EQ(all[1].ended_well, 0);
    EXPECT_EQ(all[1].runs, 1);
    EXPECT_FALSE(all[1].seconds.has_value());
    EXPECT_FALSE(all[2].spread.has_value());
}

TEST(CompareTable, CsvHasARowForEachRun) {
    const std::string text = table_csv(compared_rows);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
    EXPECT_NE(text.find("one,cube.obj,a,\"b, c\",item3d,embedded,1,,,,0.7,10,"), std::string::npos)
        << text;
}

TEST(CompareTable, HasTheColumnsThatHaveValues) {
    auto rows = compared_rows;
    const auto titles = [&] {
        std::vector<std::string> all;
        for (const TableColumn& column : table_columns(summarize(rows)))
            all.emplace_back(column.title);
        return all;
    };
    EXPECT_EQ(titles(), (std::vector<std::string>{"CLIP, direction", "\u00b1 seeds", "seconds",
                                                  "UV kept, %"}));
    rows[0]["right"] = true;
    rows[1]["right"] = false;
    EXPECT_EQ(titles().front(), "right, %");
    EXPECT_EQ(summarize(rows)[0].right, 0.5);
}

TEST(CompareTable, WhatLooksTheSameIsAsGood) {
    const auto best = [](const std::vector<double>& directions) {
        std::vector<json> rows;
        for (std::size_t i = 0; i < directions.size(); ++i)
            rows.push_back(compared("one", "m" + std::to_string(i), 0, directions[i]));
        const auto all = summarize(rows);
        const TableColumn column = table_columns(all).front();
        std::vector<bool> marks;
        for (const MethodSummary& one : all)
            marks.push_back(is_best(column, one, all));
        return marks;
    };
    EXPECT_EQ(best({0.3301, 0.3304, 0.2}), (std::vector<bool>{true, true, false}));
    EXPECT_EQ(best({0.5, 0.5}), (std::vector<bool>{false, false}));
    EXPECT_EQ(best({0.5}), (std::vector<bool>{false}));
}

TEST(ComparePairs, AreOfTheSameCaseAndSeed) {
    std::vector<json> rows;
    // The second method is better by 0.2 and 0.4 with seed 0, and worse by 0.1 with seed 1. Runs
    // without a partner do not count.
    for (const auto& [name, seed, first, second] :
         {std::tuple{"one", 0, 0.1, 0.3}, std::tuple{"two", 0, 0.2, 0.6},
          std::tuple{"one", 1, 0.5, 0.4}}) {
        rows.push_back(compared(name, "sds", seed, first));
        rows.push_back(compared(name, "item3d", seed, second));
    }
    rows.push_back(compared("two", "item3d", 1, 100));
    rows.push_back(broken("two", "in2n"));
    const auto found = beside_first(rows);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].method, "item3d");
    EXPECT_EQ(found[0].directional.pairs, 3);
    EXPECT_NEAR(found[0].directional.mean, 0.5 / 3, 1e-12);
    EXPECT_NEAR(found[0].directional.worst_seed, -0.1, 1e-12);
    EXPECT_EQ(found[0].kept.pairs, 0);
    EXPECT_EQ(found[0].seconds.pairs, 3);
    EXPECT_EQ(found[0].seconds.mean, 0);
    EXPECT_EQ(found[1].directional.pairs, 0);
}

TEST(CompareTable, LatexMarksTheBestAndEscapes) {
    const std::string text = table_latex(compared_rows);
    EXPECT_NE(text.find("item3d & 3 & \\textbf{0.433} & 0.141"), std::string::npos) << text;
    EXPECT_NE(text.find("in2n & 0 of 1 & --"), std::string::npos) << text;
    EXPECT_NE(text.find("sds\\_x & 1"), std::string::npos) << text;
}

TEST(CompareTable, OptionsAreJson) {
    auto row = compared("one", "item3d", 0, 0.5);
    row["options"] = {{"iterations", 9}};
    EXPECT_NE(table_csv({row}).find(",0,\"{\"\"iterations\"\":9}\","), std::string::npos)
        << table_csv({row});
    row["options"] = json::object();
    EXPECT_NE(table_csv({row}).find(",0,,"), std::string::npos) << table_csv({row});
}

TEST(CompareTable, TimesAreOfTheSameCasesAndSeeds) {
    std::vector<json> rows = {compared("one", "item3d", 0, 0), compared("two", "item3d", 0, 0),
                              compared("one", "sds", 0, 0)};
    rows[1]["seconds"] = 1000;
    rows[2]["seconds"] = 20;
    const auto all = summarize(rows);
    EXPECT_EQ(all[0].timed_together, 1);
    EXPECT_EQ(all[0].seconds, 10);
    EXPECT_EQ(all[1].seconds, 20);
    EXPECT_NE(table_latex(rows).find("\\textbf{10}"), std::string::npos) << table_latex(rows);
    EXPECT_TRUE(table_latex(rows).starts_with("% 2 cases; seeds: 0\n")) << table_latex(rows);
    // If the methods have no case in common, neither is best.
    rows.erase(rows.begin());
    EXPECT_EQ(summarize(rows)[0].timed_together, 0);
    EXPECT_EQ(table_latex(rows).find("\\textbf{20}"), std::string::npos) << table_latex(rows);
}

TEST(ComparePage, FailuresAreListedOnceAndEscaped) {
    const std::string page = compare_page({broken("two", "in2n"), broken("one", "in2n")}, "/", "x");
    EXPECT_NE(page.find("needs &lt;weights&gt; &amp; more"), std::string::npos);
    EXPECT_GT(page.find("<h2>Failed"), page.find("<h2>Methods"));
    const std::string one = compare_page({broken("two", "in2n")}, "/", "x");
    const std::string reason = "needs &lt;weights";
    EXPECT_EQ(one.find(reason), one.rfind(reason));
    EXPECT_NE(one.find("runs/x/log.txt"), std::string::npos);
    EXPECT_NE(one.find("\u201cb, c\u201d"), std::string::npos);
}

}  // namespace
}  // namespace item3d
