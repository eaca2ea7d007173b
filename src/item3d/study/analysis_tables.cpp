#include "item3d/study/analysis_tables.h"

#include "item3d/core/csv.h"
#include "item3d/core/latex_escape.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace item3d {
namespace {

using Json = nlohmann::json;

/// Score column of the comparison, with its titles and the direction that is better.
struct ScoreColumn {
    const char *id, *title, *latex;
    int digits;
    double scale;
    int better;  ///< 1 if higher is better, -1 if lower is better
};
constexpr std::array score_columns = {
    ScoreColumn{"clip_global", "CLIP", "CLIP $\\uparrow$", 3, 1, 1},
    ScoreColumn{"clip_directional", "CLIP dir.", "CLIP dir.\\ $\\uparrow$", 3, 1, 1},
    ScoreColumn{"seconds", "s", "Time (s) $\\downarrow$", 0, 1, -1},
    ScoreColumn{"peak_memory_bytes", "MB", "Memory (MB) $\\downarrow$", 0, 1e-6, -1}};
/// Participants below which a percentile bootstrap is far too narrow.
constexpr int few_participants = 10;
constexpr std::array question_titles = {"Photorealism", "Text consistency"};
static_assert(question_titles.size() == study_questions.size());

/// Returns the printed score; "--" if there is none.
std::string score_cell(const ScoreColumn& column, const MethodRatings& method) {
    const auto found = method.scores.find(column.id);
    if (found == method.scores.end()) return "--";
    return fmt::format("{:.{}f}", found->second * column.scale, column.digits);
}

std::string interval_text(const MeanInterval& interval) {
    return fmt::format("{:.2f} [{:.2f}, {:.2f}]", interval.mean, interval.low, interval.high);
}

std::string text_table(const StudyAnalysis& analysis) {
    std::size_t width = 6;
    for (const MethodRatings& method : analysis.methods)
        width = std::max(width, method.method.size());
    std::string text = fmt::format("{:{}}", "method", width);
    for (const ScoreColumn& column : score_columns)
        text += fmt::format("  {:>9}", column.title);
    for (const char* title : question_titles)
        text += fmt::format("  {:>19}", title);
    text += '\n';
    for (const MethodRatings& method : analysis.methods) {
        text += fmt::format("{:{}}", method.method, width);
        for (const ScoreColumn& column : score_columns)
            text += fmt::format("  {:>9}", score_cell(column, method));
        for (const MeanInterval& interval : method.ratings)
            text += fmt::format("  {:>19}", interval_text(interval));
        text += '\n';
    }
    return text;
}

std::string tests_text(const QuestionTests& tests, const char* title) {
    std::string text = fmt::format("\n{}: ", title);
    if (tests.friedman)
        text +=
            fmt::format("Friedman chi2 = {:.2f}, p = {:.3g}, Kendall's W = {:.2f}; ",
                        tests.friedman->chi_square, tests.friedman->p, tests.friedman->kendall_w);
    text += tests.alpha
                ? fmt::format("Krippendorff's alpha = {:.2f}\n", *tests.alpha)
                : std::string("Krippendorff's alpha: not defined, too few or equal ratings\n");
    for (const MethodPair& pair : tests.pairs)
        text += fmt::format(
            "  {} - {}: {:+.2f}, Wilcoxon W = {:g} of {} who rated them differently, p = {:.3g}, "
            "Holm {:.3g}, r = {:+.2f}\n",
            pair.first, pair.second, pair.difference, pair.test.statistic, pair.test.pairs,
            pair.test.p, pair.holm_p, pair.test.effect);
    return text;
}

Json pair_json(const MethodPair& pair) {
    return {{"first", pair.first},
            {"second", pair.second},
            {"difference", pair.difference},
            {"pairs", pair.test.pairs},
            {"statistic", pair.test.statistic},
            {"p", pair.test.p},
            {"holm_p", pair.holm_p},
            {"rank_biserial", pair.test.effect}};
}

Json tests_json(const QuestionTests& tests) {
    Json json = {{"friedman", nullptr}, {"krippendorff_alpha", nullptr}, {"pairs", Json::array()}};
    if (tests.friedman)
        json["friedman"] = {{"chi_square", tests.friedman->chi_square},
                            {"p", tests.friedman->p},
                            {"kendall_w", tests.friedman->kendall_w}};
    if (tests.alpha) json["krippendorff_alpha"] = *tests.alpha;
    for (const MethodPair& pair : tests.pairs)
        json["pairs"].push_back(pair_json(pair));
    return json;
}

/// True if no other method's value is better.
bool is_best_score(const ScoreColumn& column, const MethodRatings& one,
                   const StudyAnalysis& analysis) {
    const auto own = one.scores.find(column.id);
    if (own == one.scores.end()) return false;
    return std::all_of(analysis.methods.begin(), analysis.methods.end(),
                       [&](const MethodRatings& other) {
                           const auto theirs = other.scores.find(column.id);
                           return theirs == other.scores.end() ||
                                  column.better * (own->second - theirs->second) >= 0;
                       });
}

bool is_best_rating(std::size_t question, const MethodRatings& one, const StudyAnalysis& analysis) {
    return std::all_of(analysis.methods.begin(), analysis.methods.end(),
                       [&](const MethodRatings& other) {
                           return one.ratings[question].mean >= other.ratings[question].mean;
                       });
}

/// Returns "12 participants, 6 cases, 3 methods", and who was left out or included.
std::string counts_text(const StudyAnalysis& analysis) {
    std::string text = fmt::format("{} participants, {} cases, {} methods", analysis.participants,
                                   analysis.cases, analysis.methods.size());
    if (analysis.unfinished > 0)
        text += fmt::format("; left out because not finished: {}", analysis.unfinished);
    if (analysis.inattentive > 0)
        text += fmt::format("; {} after failed attention checks: {}",
                            analysis.counts_inattentive ? "included" : "left out",
                            analysis.inattentive);
    return text;
}

std::string latex_cell(const std::string& text, bool is_best) {
    return is_best ? " & \\textbf{" + text + "}" : " & " + text;
}

}  // namespace

std::string analysis_text(const StudyAnalysis& analysis) {
    std::string text = counts_text(analysis);
    if (analysis.participants < few_participants)
        text += fmt::format("\nWith fewer than {} participants, intervals and tests say little.",
                            few_participants);
    text += "\n\n" + text_table(analysis);
    for (std::size_t question = 0; question < study_questions.size(); ++question)
        text += tests_text(analysis.questions[question], question_titles[question]);
    return text;
}

Json analysis_json(const StudyAnalysis& analysis) {
    Json json = {{"participants", analysis.participants},
                 {"unfinished", analysis.unfinished},
                 {"inattentive", analysis.inattentive},
                 {"counts_inattentive", analysis.counts_inattentive},
                 {"cases", analysis.cases},
                 {"methods", Json::array()},
                 {"questions", Json::object()}};
    for (const MethodRatings& method : analysis.methods) {
        Json row = {{"method", method.method}, {"scores", method.scores}};
        for (std::size_t question = 0; question < study_questions.size(); ++question) {
            const MeanInterval& interval = method.ratings[question];
            row[std::string(study_questions[question].id)] = {
                {"mean", interval.mean}, {"low", interval.low}, {"high", interval.high}};
        }
        json["methods"].push_back(std::move(row));
    }
    for (std::size_t question = 0; question < study_questions.size(); ++question)
        json["questions"][std::string(study_questions[question].id)] =
            tests_json(analysis.questions[question]);
    return json;
}

std::string analysis_csv(const StudyAnalysis& analysis) {
    std::vector<std::string> header = {"method"};
    for (const ScoreColumn& column : score_columns)
        header.emplace_back(column.id);
    for (const StudyQuestion& question : study_questions)
        for (const char* part : {"", "_low", "_high"})
            header.push_back(std::string(question.id) + part);
    for (const char* count : {"participants", "inattentive_included", "cases"})
        header.emplace_back(count);
    std::string text = csv_line(header);
    for (const MethodRatings& method : analysis.methods) {
        std::vector<std::string> row = {method.method};
        for (const ScoreColumn& column : score_columns) {
            const auto found = method.scores.find(column.id);
            row.push_back(found == method.scores.end() ? "" : fmt::format("{:.6g}", found->second));
        }
        for (const MeanInterval& interval : method.ratings)
            for (const double value : {interval.mean, interval.low, interval.high})
                row.push_back(fmt::format("{:.4f}", value));
        row.push_back(std::to_string(analysis.participants));
        row.push_back(std::to_string(analysis.counts_inattentive ? analysis.inattentive : 0));
        row.push_back(std::to_string(analysis.cases));
        text += csv_line(row);
    }
    return text;
}

std::string analysis_latex(const StudyAnalysis& analysis) {
    const std::size_t columns = score_columns.size() + study_questions.size();
    std::string text = "% " + counts_text(analysis) + "\n\\begin{tabular}{l" +
                       std::string(columns, 'r') + "}\n\\toprule\nMethod";
    for (const ScoreColumn& column : score_columns)
        text += fmt::format(" & {}", column.latex);
    for (const char* title : question_titles)
        text += fmt::format(" & {} $\\uparrow$", title);
    text += " \\\\\n\\midrule\n";
    for (const MethodRatings& method : analysis.methods) {
        text += latex_escape(method.method);
        for (const ScoreColumn& column : score_columns)
            text += latex_cell(score_cell(column, method), is_best_score(column, method, analysis));
        for (std::size_t question = 0; question < study_questions.size(); ++question) {
            const MeanInterval& interval = method.ratings[question];
            const double reach =
                std::max(interval.high - interval.mean, interval.mean - interval.low);
            text += latex_cell(fmt::format("{:.2f}", interval.mean),
                               is_best_rating(question, method, analysis)) +
                    fmt::format(" $\\pm$ {:.2f}", reach);
        }
        text += " \\\\\n";
    }
    return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string ratings_csv(const Study& study, const std::map<std::int64_t, AnswersByItem>& answers) {
    std::vector<std::string> header = {"participant", "counted", "kind", "case", "method"};
    for (const StudyQuestion& question : study_questions)
        header.emplace_back(question.id);
    std::string text = csv_line(header);
    for (const auto& [participant, given] : answers) {
        const bool is_counted = counts(study, given);
        for (const StudyItem& item : study.items) {
            const auto answer = given.find(item.id);
            if (answer == given.end()) continue;
            std::vector<std::string> row = {std::to_string(participant), is_counted ? "yes" : "no",
                                            std::string(kind_name(item.kind)), item.case_name,
                                            item.method};
            for (const int value : answer->second)
                row.push_back(std::to_string(value));
            text += csv_line(row);
        }
    }
    return text;
}

}  // namespace item3d
