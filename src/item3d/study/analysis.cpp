#include "item3d/study/analysis.h"

#include "item3d/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

using Answers = std::map<std::int64_t, AnswersByItem>;

bool has_rated_all(const Study& study, const AnswersByItem& answers) {
    return std::all_of(study.items.begin(), study.items.end(), [&](const StudyItem& item) {
        return item.kind != StudyItemKind::rating || answers.contains(item.id);
    });
}

bool is_attentive(const Study& study, const AnswersByItem& answers) {
    return std::all_of(study.items.begin(), study.items.end(), [&](const StudyItem& item) {
        if (item.kind != StudyItemKind::attention) return true;
        const auto given = answers.find(item.id);
        return given != answers.end() && given->second == item.expected;
    });
}

std::vector<const AnswersByItem*> raters_of(const Study& study, const Answers& answers,
                                            StudyAnalysis& analysis) {
    std::vector<const AnswersByItem*> raters;
    for (const auto& [participant, given] : answers) {
        if (!has_rated_all(study, given)) {
            ++analysis.unfinished;
            continue;
        }
        const bool attentive = is_attentive(study, given);
        if (!attentive) ++analysis.inattentive;
        if (attentive || analysis.counts_inattentive) raters.push_back(&given);
    }
    return raters;
}

/// Returns the means over cases, [raters][methods].
std::vector<std::vector<double>> rater_means(const Study& study,
                                             const std::vector<const AnswersByItem*>& raters,
                                             std::size_t question) {
    std::vector<std::vector<double>> means;
    for (const AnswersByItem* rater : raters) {
        std::vector<double> sums(study.methods.size(), 0.0), counts(study.methods.size(), 0.0);
        for (const StudyItem& item : study.items) {
            if (item.kind != StudyItemKind::rating) continue;
            const auto method = static_cast<std::size_t>(
                std::find(study.methods.begin(), study.methods.end(), item.method) -
                study.methods.begin());
            sums[method] += rater->at(item.id)[question];
            ++counts[method];
        }
        for (std::size_t method = 0; method < sums.size(); ++method)
            sums[method] /= counts[method];
        means.push_back(std::move(sums));
    }
    return means;
}

std::vector<double> column_of(const std::vector<std::vector<double>>& rows, std::size_t column) {
    std::vector<double> values;
    for (const auto& row : rows)
        values.push_back(row[column]);
    return values;
}

std::optional<double> agreement(const Study& study, const std::vector<const AnswersByItem*>& raters,
                                std::size_t question) {
    std::vector<std::vector<std::optional<int>>> ratings;
    for (const AnswersByItem* rater : raters) {
        ratings.emplace_back();
        for (const StudyItem& item : study.items)
            if (item.kind == StudyItemKind::rating)
                ratings.back().emplace_back(rater->at(item.id)[question]);
    }
    return krippendorff_alpha(ratings);
}

std::vector<MethodPair> all_pairs(const std::vector<std::string>& methods,
                                  const std::vector<std::vector<double>>& means) {
    std::vector<MethodPair> pairs;
    std::vector<double> p;
    for (std::size_t a = 0; a < methods.size(); ++a) {
        for (std::size_t b = a + 1; b < methods.size(); ++b) {
            MethodPair pair;
            pair.first = methods[a];
            pair.second = methods[b];
            std::vector<double> differences;
            for (const auto& rater : means) {
                differences.push_back(rater[a] - rater[b]);
                pair.difference += differences.back() / static_cast<double>(means.size());
            }
            pair.test = wilcoxon_signed_rank(differences);
            p.push_back(pair.test.p);
            pairs.push_back(std::move(pair));
        }
    }
    const std::vector<double> adjusted = holm(p);
    for (std::size_t i = 0; i < pairs.size(); ++i)
        pairs[i].holm_p = adjusted[i];
    return pairs;
}

/// True if the runs of all methods in this case have the score.
bool all_have_score(const Study& study, const std::string& case_name, const std::string& score) {
    return std::all_of(study.items.begin(), study.items.end(), [&](const StudyItem& item) {
        return item.kind != StudyItemKind::rating || item.case_name != case_name ||
               item.scores.contains(score);
    });
}

std::map<std::string, double> mean_scores(const Study& study, const std::string& method) {
    std::map<std::string, double> sums, counts;
    for (const StudyItem& item : study.items) {
        if (item.kind != StudyItemKind::rating || item.method != method) continue;
        for (const auto& [name, value] : item.scores) {
            if (!all_have_score(study, item.case_name, name)) continue;
            sums[name] += value;
            ++counts[name];
        }
    }
    for (auto& [name, sum] : sums)
        sum /= counts[name];
    return sums;
}

}  // namespace

bool counts(const Study& study, const AnswersByItem& answers) {
    return has_rated_all(study, answers) && is_attentive(study, answers);
}

StudyAnalysis analyze_study(const Study& study, const Answers& answers,
                            const AnalysisOptions& options, const std::string& subject) {
    StudyAnalysis analysis;
    analysis.counts_inattentive = options.counts_inattentive;
    const auto raters = raters_of(study, answers, analysis);
    if (raters.empty())
        throw InputError(subject,
                         fmt::format("has no participant to count: of {} who started, {} have not "
                                     "finished and {} failed an attention check",
                                     answers.size(), analysis.unfinished, analysis.inattentive),
                         analysis.inattentive > 0 ? "--all includes those who failed it"
                                                  : "wait until a participant has finished");
    analysis.participants = static_cast<int>(raters.size());
    std::set<std::string> cases;
    for (const StudyItem& item : study.items)
        if (item.kind == StudyItemKind::rating) cases.insert(item.case_name);
    analysis.cases = static_cast<int>(cases.size());
    for (const std::string& method : study.methods)
        analysis.methods.push_back({method, {}, mean_scores(study, method)});
    for (std::size_t question = 0; question < study_questions.size(); ++question) {
        const auto means = rater_means(study, raters, question);
        for (std::size_t method = 0; method < study.methods.size(); ++method)
            analysis.methods[method].ratings[question] =
                bootstrap_mean(column_of(means, method), options.resamples, options.seed);
        QuestionTests& tests = analysis.questions[question];
        if (means.size() >= 2 && study.methods.size() >= 3) tests.friedman = friedman(means);
        tests.pairs = all_pairs(study.methods, means);
        tests.alpha = agreement(study, raters, question);
    }
    return analysis;
}

}  // namespace item3d
