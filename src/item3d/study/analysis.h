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
    /// True if participants who failed an attention page are included.
    bool counts_inattentive = false;
    int resamples = 10000;   ///< number of bootstrap resamples
    std::uint64_t seed = 0;  ///< seed of the bootstrap
};

/// Columns of a method in the table.
struct MethodRatings {
    std::string method;
    /// Mean of each question. It is taken first over a participant's cases, then over participants.
    /// The confidence interval comes from resampling participants.
    std::array<MeanInterval, study_questions.size()> ratings;
    /// Means of the rated runs' scores, with the keys of ComparisonRow::scores. A mean is over the
    /// cases in which all methods have the score.
    std::map<std::string, double> scores;
};

/// Comparison of the participants' means of `first` and `second`.
struct MethodPair {
    std::string first, second;
    double difference = 0;  ///< difference of the means, first minus second
    Wilcoxon test;
    double holm_p = 1;  ///< p, adjusted for all pairs of a question (Holm)
};

struct QuestionTests {
    std::optional<Friedman> friedman;  ///< unset below three methods or two participants
    std::vector<MethodPair> pairs;
    std::optional<double> alpha;  ///< krippendorff_alpha() of participants over rated items
};

struct StudyAnalysis {
    int participants = 0;  ///< number of included participants
    /// Number of participants who have not rated all items; they are excluded.
    int unfinished = 0;
    int inattentive = 0;  ///< number of participants who failed an attention page
    bool counts_inattentive = false;
    int cases = 0;
    std::vector<MethodRatings> methods;  ///< methods in the study's order
    std::array<QuestionTests, study_questions.size()> questions;
};

/// True if a participant rated all items and passed the attention pages.
bool counts(const Study& study, const AnswersByItem& answers);

/// Analyses participants who rated all items and, unless the options say otherwise, passed the
/// attention pages. Throws InputError, with `subject`, if no participants are left.
StudyAnalysis analyze_study(const Study& study,
                            const std::map<std::int64_t, AnswersByItem>& answers,
                            const AnalysisOptions& options, const std::string& subject);

}  // namespace item3d
