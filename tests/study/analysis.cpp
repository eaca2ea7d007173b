#include "item3d/study/analysis.h"

#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/study/analysis_tables.h"
#include "tests/support/study.h"

#include <nlohmann/json.hpp>

namespace item3d::testing {
namespace {

// Photorealism as rated by six raters, for two cases and three methods. SciPy 1.17.1, statsmodels
// 0.14 and krippendorff 0.9.0 give the numbers of the first test:
//
//   r = np.array(ratings)
//   m = r.mean(1)
//   stats.friedmanchisquare(*m.T)
//   d = m[:, a] - m[:, b]
//   stats.wilcoxon(d[d != 0], method=stats.PermutationMethod(n_resamples=np.inf))
//   multipletests(p, method='holm')
//   krippendorff.alpha(reliability_data=r.reshape(6, -1), level_of_measurement='ordinal')
constexpr int ratings[6][2][3] = {{{5, 3, 2}, {4, 3, 3}}, {{4, 4, 1}, {5, 2, 2}},
                                  {{3, 2, 2}, {4, 4, 2}}, {{5, 4, 3}, {3, 3, 1}},
                                  {{4, 2, 2}, {5, 4, 4}}, {{2, 3, 1}, {4, 4, 2}}};

/// Fixture: the scores of the runs are set, and text consistency is 3 in every answer.
class StudyAnalyzed : public ::testing::Test {
  protected:
    void SetUp() override {
        int place = 0;
        for (StudyItem& item : study_.items) {
            for (int rater = 0; rater < 6; ++rater) {
                StudyAnswer answer = item.expected;
                if (item.kind == StudyItemKind::rating)
                    answer = {ratings[rater][place / 3][place % 3], 3};
                if (item.kind == StudyItemKind::practice) answer = {1, 1};
                answers_[rater + 1][item.id] = answer;
            }
            if (item.kind != StudyItemKind::rating) continue;
            item.scores = {{"clip_global", 0.2 + 0.01 * place}, {"seconds", 10.0 * (place + 1)}};
            ++place;
        }
        study_.items[6].scores.erase("clip_global");  // the cow edited by clip
    }
    StudyAnalysis analyze(bool counts_inattentive = false) const {
        AnalysisOptions options;
        options.counts_inattentive = counts_inattentive;
        return analyze_study(study_, answers_, options, "study");
    }

    Study study_ = small_study();
    std::map<std::int64_t, AnswersByItem> answers_;
};

TEST_F(StudyAnalyzed, ByTheNumbersOfSciPy) {
    const StudyAnalysis analysis = analyze();
    EXPECT_EQ(analysis.participants, 6);
    EXPECT_EQ(analysis.cases, 2);
    const QuestionTests& tests = analysis.questions[0];
    EXPECT_NEAR(analysis.methods[1].ratings[0].mean, 3.1666666666666665, 1e-12);
    EXPECT_NEAR(tests.friedman->chi_square, 9.652173913043478, 1e-12);
    EXPECT_NEAR(tests.friedman->p, 0.008017834095185418, 1e-13);
    ASSERT_EQ(tests.pairs.size(), 3u);
    const double p[] = {0.125, 0.03125, 0.0625}, holm_p[] = {0.125, 0.09375, 0.125};
    const double differences[] = {0.8333333333333334, 1.9166666666666667, 1.0833333333333333};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(tests.pairs[i].test.p, p[i], 1e-14) << i;
        EXPECT_NEAR(tests.pairs[i].holm_p, holm_p[i], 1e-14) << i;
        EXPECT_NEAR(tests.pairs[i].difference, differences[i], 1e-12) << i;
    }
    EXPECT_EQ(tests.pairs[1].first + tests.pairs[1].second, "plainclip");
    EXPECT_NEAR(*tests.alpha, 0.3915839470594513, 1e-12);
    // Without differences there is no statistic, instead of a wrong one.
    EXPECT_FALSE(analysis.questions[1].friedman);
    EXPECT_FALSE(analysis.questions[1].alpha);
    EXPECT_EQ(analysis.questions[1].pairs[0].test.p, 1);
}

TEST_F(StudyAnalyzed, CountsWhoReadsAndComesToTheEnd) {
    answers_[1][study_.items.back().id] = {1, 1};
    answers_[2].erase(study_.items[3].id);
    answers_[3].erase(study_.items[0].id);  // an answer to the practice item
    StudyAnalysis analysis = analyze();
    EXPECT_EQ(analysis.participants, 4);
    EXPECT_EQ(analysis.unfinished, 1);
    EXPECT_EQ(analysis.inattentive, 1);
    EXPECT_NE(analysis_text(analysis).find("left out after failed attention checks: 1"),
              std::string::npos);
    analysis = analyze(true);
    EXPECT_EQ(analysis.participants, 5);
    for (auto& [participant, given] : answers_)
        given.erase(study_.items[3].id);
    EXPECT_THROW(analyze(), InputError);
    answers_.clear();
    EXPECT_THROW(analyze(), InputError);
}

TEST_F(StudyAnalyzed, FillsThePapersColumns) {
    const StudyAnalysis analysis = analyze();
    const CsvRows rows = parse_csv(analysis_csv(analysis), "table");
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0][1], "clip_global");
    EXPECT_EQ(rows[2][0], "texture");
    EXPECT_NEAR(std::stod(rows[2][1]), 0.21, 1e-9);  // the mug: clip has no score of the cow
    EXPECT_EQ(rows[2][2], "") << "no directional score was given";
    EXPECT_EQ(rows[2][3], "35");  // mean of 20 and 50 seconds
    EXPECT_EQ(rows[2][5], "3.1667");

    study_.methods[0] = "plain_50%";
    for (StudyItem& item : study_.items)
        if (item.method == "plain") item.method = study_.methods[0];
    const std::string latex = analysis_latex(analyze());
    EXPECT_NE(latex.find("plain\\_50\\% & 0.200 & -- & \\textbf{25} & -- & \\textbf{4.00}"),
              std::string::npos)
        << latex;
    EXPECT_NE(latex.find("clip & \\textbf{0.220} & --"), std::string::npos)
        << "over the cases in which all have the score: " << latex;
    EXPECT_EQ(latex.find("% 6 participants, 2 cases, 3 methods\n"), 0u) << latex;

    const nlohmann::json json = analysis_json(analysis);
    EXPECT_EQ(json["methods"][0]["photorealism"]["mean"], 4);
    EXPECT_EQ(json["questions"]["photorealism"]["pairs"].size(), 3u);
    EXPECT_TRUE(json["questions"]["text_consistency"]["friedman"].is_null());
    EXPECT_EQ(parse_csv(ratings_csv(study_, answers_), "ratings").size(), 1 + 6 * 8u);
}

TEST_F(StudyAnalyzed, OfOneParticipantAndTwoMethods) {
    study_.methods.pop_back();
    std::erase_if(study_.items, [](const StudyItem& item) { return item.method == "clip"; });
    answers_.erase(answers_.begin(), std::prev(answers_.end()));
    const StudyAnalysis analysis = analyze();
    EXPECT_EQ(analysis.participants, 1);
    EXPECT_FALSE(analysis.questions[0].friedman);
    EXPECT_FALSE(analysis.questions[0].alpha);
    EXPECT_EQ(analysis.questions[0].pairs.size(), 1u);
    EXPECT_EQ(analysis.methods[0].ratings[0].low, analysis.methods[0].ratings[0].high);
    EXPECT_FALSE(analysis_text(analysis).empty());
}

}  // namespace
}  // namespace item3d::testing
