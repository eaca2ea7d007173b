// Statistics of a study's ratings, by method.
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
    bool counts_inattentive = false;  ///< also who chose other numbers than an attention page asked
    int resamples = 10000;            ///< of the bootstrap
    std::uint64_t seed = 0;           ///< of the bootstrap
};

/// A method's columns of the table.
struct MethodRatings {
    std::string method;
    /// For each question: mean over participants of their mean over cases, with the interval that
    /// resampling participants gives.
    std::array<MeanInterval, study_questions.size()> ratings;
    /// Means over the study's cases of the runs that were rated: keys of ComparisonRow::scores.
    std::map<std::string, double> scores;
};

/// Participants' means of `first` against those of `second`.
struct MethodPair {
    std::string first, second;
    double difference = 0;  ///< of the means, first less second
    Wilcoxon test;
    double holm_p = 1;  ///< p adjusted for all pairs of a question
};

struct QuestionTests {
    std::optional<Friedman> friedman;  ///< none below three methods or two participants
    std::vector<MethodPair> pairs;
    std::optional<double> alpha;  ///< krippendorff_alpha() of participants over rated items
};

struct StudyAnalysis {
    int participants = 0;  ///< who count
    int unfinished = 0;    ///< who began and have not rated all items; left out
    int inattentive = 0;   ///< who answered an attention page otherwise
    bool counts_inattentive = false;
    int cases = 0;
    std::vector<MethodRatings> methods;  ///< in the study's order
    std::array<QuestionTests, study_questions.size()> questions;
};

/// Counts participants who rated all items and, unless the options say otherwise, chose what the
/// attention pages ask for. Throws InputError, with `subject`, where nobody is left.
StudyAnalysis analyze_study(const Study& study,
                            const std::map<std::int64_t, AnswersByItem>& answers,
                            const AnalysisOptions& options, const std::string& subject);

}  // namespace item3d
