#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
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
        save_image(run / "before.png", sheet(0));
        save_image(run / "after.png", sheet(++runs_));
        write_atomically(run / "turntable.webp", Bytes(whole_webp.begin(), whole_webp.end()));
        table_ += name + "," + name + ".glb,\"a red, old " + name + "\",a blue one," + method +
                  ",embedded,0," + name + "/" + method + ",12.5\n";
    }
    /// Returns a sheet of 40 x 60 pixels. Its first 30 rows are a title on white paper, the others
    /// are views of one grey.
    static Image sheet(int grey) {
        Image image(40, 60, 3, 1);
        for (int x = 14; x < 20; ++x)
            image.at(x, 8, 0) = 0;
        for (int y = 30; y < 48; ++y)
            for (int x = 4; x < 36; ++x)
                for (int c = 0; c < 3; ++c)
                    image.at(x, y, c) = static_cast<float>(grey) / 255;
        return image;
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

    static constexpr std::string_view whole_webp{"RIFF\x04\0\0\0WEBP", 12};
    fs::path folder_;
    int runs_ = 0;
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
        // The study shows the views without the title, because the title says what was asked for.
        const Image shown = load_image(folder_ / "study/pictures" / item.after);
        const Image whole =
            load_image(folder_ / "comparison" / item.case_name / item.method / "after.png");
        EXPECT_EQ(shown.height, 60 - 18);
        EXPECT_EQ(shown.at(20, 20, 0), whole.at(20, 38, 0));
        EXPECT_EQ(shown.at(16, 0, 0), 1);
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
    table_ = whole.substr(0, whole.size() - 6);  // cuts the last row
    expect_refused("row 6 has 8 cells");
    table_ = whole + "\"mug";
    expect_refused("a quotation mark is not closed");
    table_ = whole;
    EXPECT_FALSE(fs::exists(folder_ / "study/pictures"));
    for (const auto& [file, kept] : {std::pair{"after.png", 20}, std::pair{"turntable.webp", 10}}) {
        const fs::path path = folder_ / "comparison/cow/clip" / file;
        const std::string bytes = read_text(path);
        fs::resize_file(path, kept);
        expect_refused(file);
        EXPECT_FALSE(fs::exists(folder_ / "study/pictures")) << file;
        std::ofstream(path, std::ios::binary) << bytes;
    }
}

TEST_F(MakeStudy, RefusesTextsThatParticipantsCannotRead) {
    const auto refused = [&](const std::string& title, const std::string& consent) {
        MakeStudyRequest wrong = request();
        wrong.title = title;
        wrong.consent = folder_ / "consent.txt";
        std::ofstream(wrong.consent, std::ios::binary) << consent;
        EXPECT_THROW(make_study(wrong), InputError) << title << consent;
        EXPECT_FALSE(fs::exists(folder_ / "study"));
    };
    refused("a\xe9", "We store your ratings.");
    refused(" ", "We store your ratings.");
    refused("Mugs", "\xff\xfe");
    refused("Mugs", " \n");
}

TEST_F(MakeStudy, MissingImagesAreNamed) {
    const Study study = make_study(request());
    check_study_images(study, folder_ / "study");
    fs::resize_file(folder_ / "study/pictures" / study.items[3].after, 0);
    EXPECT_THROW(check_study_images(study, folder_ / "study"), InputError);
    fs::remove(folder_ / "study/pictures" / study.items[3].after);
    EXPECT_THROW(check_study_images(study, folder_ / "study"), InputError);
}

}  // namespace
}  // namespace item3d
