// Statistical analysis of a study's ratings, by method.
#pragma once

#include "item3d/study/answers.h"
#include "item3d/study/statistics.h"
#include "item3d/study/study.h"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct AnalysisOptions {
    bool counts_inattentive = false;  ///< true: include participants who failed an attention page
    int resamples = 10000;            ///< number of bootstrap resamples
    std::uint64_t seed = 0;           ///< seed of the bootstrap
};

/// Columns of a method in the table.
struct MethodRatings {
    std::string method;
    /// Mean of each question: first over a participant's cases, then over participants. The
    /// confidence interval comes from resampling participants.
    std::array<MeanInterval, study_questions.size()> ratings;
    /// Means of the rated runs by key of ComparisonRow::scores, over the cases in which all methods
    /// have that score.
    std::map<std::string, double> scores;
};

/// Comparison of the participants' means of `first` and `second`.
struct MethodPair {
    std::string first, second;
    double difference = 0;  ///< difference of the means, first minus second
    Wilcoxon test;
    double holm_p = 1;  ///< p adjusted for all pairs of a question
};

struct QuestionTests {
    std::optional<Friedman> friedman;  ///< unset below three methods or two participants
    std::vector<MethodPair> pairs;
    std::optional<double> alpha;  ///< krippendorff_alpha() of participants over rated items
};

struct StudyAnalysis {
    int participants = 0;  ///< number of included participants
    int unfinished = 0;    ///< participants who have not rated all items; excluded
    int inattentive = 0;   ///< participants who failed an attention page
    bool counts_inattentive = false;
    int cases = 0;
    std::vector<MethodRatings> methods;  ///< in the study's order
    std::array<QuestionTests, study_questions.size()> questions;
};

/// True if a participant rated all items and passed the attention pages.
bool counts(const Study& study, const AnswersByItem& answers);

/// Analyses participants who rated all items and, unless the options say otherwise, passed the
/// attention pages. Throws InputError, with `subject`, if none are left.
StudyAnalysis analyze_study(const Study& study,
                            const std::map<std::int64_t, AnswersByItem>& answers,
                            const AnalysisOptions& options, const std::string& subject);

}  // namespace item3d
