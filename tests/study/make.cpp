#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/study/comparison_table.h"
#include "item3d/study/make_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

class MakeStudy : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::path(::testing::TempDir()) / "item3d_make_study";
        fs::remove_all(folder_);
        for (const char* name : {"mug", "cow"})
            for (const char* method : {"plain", "texture", "clip"})
                add_run(name, method);
    }
    void TearDown() override { fs::remove_all(folder_); }

    void add_run(const std::string& name, const std::string& method) {
        const fs::path run = folder_ / "comparison" / name / method;
        fs::create_directories(run);
        for (const char* file : {"before.png", "after.png", "turntable.webp"})
            std::ofstream(run / file) << name << method << file;
        table_ += name + "," + name + ".glb,\"a red, old " + name + "\",a blue one," + method +
                  ",embedded,0," + name + "/" + method + ",12.5\n";
    }
    MakeStudyRequest request(const std::string& output = "study") {
        std::ofstream(folder_ / "comparison/table.csv") << table_;
        MakeStudyRequest request;
        request.comparison = folder_ / "comparison";
        request.output = folder_ / output;
        return request;
    }
    void expect_refused(const std::string& subject) {
        try {
            make_study(request());
            FAIL() << "not refused: " << subject;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(subject), std::string::npos) << error.what();
        }
    }

    fs::path folder_;
    std::string table_ = "case,model,from,to,method,prior,seed,folder,seconds\n";
};

TEST_F(MakeStudy, HasEveryMethodOfEveryCaseUnderHiddenNames) {
    make_study(request());
    const Study study = read_study(folder_ / "study");
    EXPECT_EQ(study.methods, (std::vector<std::string>{"plain", "texture", "clip"}));
    std::set<std::string> rated;
    int practice = 0, attention = 0;
    for (const StudyItem& item : study.items) {
        practice += item.kind == StudyItemKind::practice;
        attention += item.kind == StudyItemKind::attention;
        if (item.kind == StudyItemKind::attention) {
            EXPECT_NE(item.expected[0], item.expected[1]);
            for (const int value : item.expected)
                EXPECT_TRUE(value >= min_rating && value <= max_rating) << value;
        }
        for (const std::string& name : {item.id, item.before, item.after, item.turntable})
            for (const std::string& method : study.methods)
                EXPECT_EQ(name.find(method), std::string::npos) << name;
        if (item.kind != StudyItemKind::rating) continue;
        rated.insert(item.case_name + item.method);
        EXPECT_EQ(read_text(folder_ / "study/pictures" / item.after),
                  item.case_name + item.method + "after.png");
        EXPECT_EQ(item.from, "a red, old " + item.case_name);
        EXPECT_EQ(item.scores.at("seconds"), 12.5);
    }
    EXPECT_EQ(rated.size(), 6u);
    EXPECT_EQ(practice, 2);
    EXPECT_EQ(attention, 2);
}

TEST_F(MakeStudy, LeavesOutCasesThatLackAMethod) {
    fs::remove(folder_ / "comparison/cow/clip/after.png");
    const Study study = make_study(request());
    EXPECT_EQ(std::count_if(study.items.begin(), study.items.end(),
                            [](const StudyItem& item) { return item.case_name == "cow"; }),
              0);
    fs::remove(folder_ / "comparison/mug/plain/turntable.webp");
    fs::remove_all(folder_ / "study");
    expect_refused("no case has results of all methods");
}

TEST_F(MakeStudy, RefusesOneMethodBrokenTablesAndASecondStudy) {
    make_study(request());
    expect_refused("already contains a study");
    fs::remove_all(folder_ / "study");
    const std::string whole = table_;
    table_ = "case,model,from,to,method,prior,seed,folder\nmug,m,a,b,plain,p,0,mug/plain\n";
    expect_refused("one method");
    table_ = "case,model,from,to,prior,seed,folder\nmug,m,a,b,p,0,mug/plain\n";
    expect_refused("no column 'method'");
    table_ = whole.substr(0, whole.size() - 6);  // within the last row
    expect_refused("row 6 has 8 cells");
    table_ = whole + "\"mug";
    expect_refused("a quotation mark is not closed");
}

}  // namespace
}  // namespace item3d
