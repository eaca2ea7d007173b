// Output of an analysis as text, JSON, CSV and LaTeX.
#pragma once

#include "item3d/study/analysis.h"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>

namespace item3d {

/// Returns text for a terminal, with the participants, the table, and the tests of each question.
std::string analysis_text(const StudyAnalysis& analysis);
nlohmann::json analysis_json(const StudyAnalysis& analysis);
/// Returns a row for each method. Its columns are the method, the scores, and the ratings with the
/// ends of their intervals.
std::string analysis_csv(const StudyAnalysis& analysis);
/// Returns the paper's table (booktabs), with CLIP scores, time, memory and ratings. The best value
/// of a column is bold.
std::string analysis_latex(const StudyAnalysis& analysis);
/// Returns a row for each answer of all participants. Its columns are the participant, the kind,
/// the case, the method and the questions.
std::string ratings_csv(const Study& study, const std::map<std::int64_t, AnswersByItem>& answers);

}  // namespace item3d
