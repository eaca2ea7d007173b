// Output of an analysis as text, JSON, CSV and LaTeX.
#pragma once

#include "item3d/study/analysis.h"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>

namespace item3d {

/// Returns text for a terminal: participants, the table, the tests of each question.
std::string analysis_text(const StudyAnalysis& analysis);
nlohmann::json analysis_json(const StudyAnalysis& analysis);
/// Returns a row for each method: method, scores, ratings with the ends of their intervals.
std::string analysis_csv(const StudyAnalysis& analysis);
/// Returns the paper's table (booktabs): CLIP scores, time, memory, ratings; the best of a column
/// in bold.
std::string analysis_latex(const StudyAnalysis& analysis);
/// Returns a row for each answer of all participants: participant, kind, case, method, questions.
std::string ratings_csv(const Study& study, const std::map<std::int64_t, AnswersByItem>& answers);

}  // namespace item3d
