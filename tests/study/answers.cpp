// Tests that acknowledged answers are on disk, and that files other than this study's database are
// refused and left unchanged.
#include "item3d/study/answers.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "tests/support/study.h"

#include <set>

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;

class StudyAnswers : public StudyFolder {
  protected:
    void expect_unreadable(const std::string& problem) {
        for (const bool serving : {true, false}) {
            try {
                if (serving)
                    AnswerStore(folder_, study_);
                else
                    read_answers(folder_, study_);
                ADD_FAILURE() << "not refused: " << problem;
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find(problem), std::string::npos)
                    << error.what();
            }
        }
    }
    fs::path database() const { return folder_ / "answers.sqlite"; }
};

TEST_F(StudyAnswers, AreKeptAndReplaced) {
    std::string token;
    {
        AnswerStore store(folder_, study_);
        store.add_participants(2);
        token = store.participants().at(1).token;
        EXPECT_FALSE(store.find(token)->has_agreed);
        store.agree(2);
        store.store(2, "a", {1, 5});
        store.store(2, "b", {3, 3});
        store.store(2, "a", {2, 4});
        EXPECT_EQ(read_answers(folder_, study_).at(2).at("a"), (StudyAnswer{2, 4}));
    }
    AnswerStore store(folder_, study_);
    store.add_participants(4);
    store.add_participants(1);
    ASSERT_EQ(store.participants().size(), 4u);
    std::set<std::string> tokens;
    for (const Participant& participant : store.participants())
        tokens.insert(participant.token);
    EXPECT_EQ(tokens.size(), 4u);
    EXPECT_EQ(tokens.begin()->size(), 20u);
    EXPECT_EQ(store.find(token)->number, 2);
    EXPECT_TRUE(store.find(token)->has_agreed);
    EXPECT_FALSE(store.find("' OR 1 --"));
    EXPECT_EQ(store.answers(2), (AnswersByItem{{"a", {2, 4}}, {"b", {3, 3}}}));
    EXPECT_TRUE(store.answers(1).empty());
}

TEST_F(StudyAnswers, OutOfRangeAreRefusedByTheDatabaseItself) {
    AnswerStore store(folder_, study_);
    store.add_participants(1);
    EXPECT_THROW(store.store(1, "a", {0, 3}), InputError);
    EXPECT_THROW(store.store(1, "a", {3, 6}), InputError);
    EXPECT_THROW(store.store(7, "a", {3, 3}), InputError);
    EXPECT_TRUE(store.answers(1).empty());
}

TEST_F(StudyAnswers, HaveOneServerAtATime) {
    AnswerStore first(folder_, study_);
    try {
        AnswerStore(folder_, study_);
        ADD_FAILURE() << "two servers have one database";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("is already served"), std::string::npos);
    }
}

TEST_F(StudyAnswers, CutOffAreRefusedAndLeft) {
    {
        AnswerStore store(folder_, study_);
        store.add_participants(300);
        for (int participant = 1; participant <= 3; ++participant)
            store.store(participant, "a", {1, 5});
    }
    const std::string whole = read_text(database());
    ASSERT_GT(whole.size(), 4 * 4096u);
    for (const std::size_t size : {std::size_t{2}, std::size_t{100}, std::size_t{4096},
                                   whole.size() / 2, whole.size() - 1}) {
        write_atomically(database(), std::string_view(whole).substr(0, size));
        expect_unreadable("is damaged");
        EXPECT_EQ(read_text(database()), whole.substr(0, size));
    }
    for (const std::size_t size : {0, 1}) {
        write_atomically(database(), std::string_view(whole).substr(0, size));
        expect_unreadable("is empty");
    }
    write_atomically(database(), whole);
    EXPECT_EQ(read_answers(folder_, study_).size(), 3u);
}

TEST_F(StudyAnswers, OfAnotherStudyAreRefused) {
    EXPECT_THROW(read_answers(folder_, study_), InputError);
    EXPECT_FALSE(fs::exists(database()));
    { AnswerStore(folder_, study_); }
    study_.consent += ".";
    expect_unreadable("another study.json");
}

}  // namespace
}  // namespace item3d::testing
