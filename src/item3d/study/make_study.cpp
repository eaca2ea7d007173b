#include "item3d/study/make_study.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/study/comparison_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr const char* draft_consent =
    "You will see objects before and after an edit that is described by a sentence, and rate each "
    "edit with two questions. A page takes about 30 seconds.\n"
    "\n"
    "Participation is voluntary. You can stop at any time by closing the page and continue later "
    "with the same link. We store your ratings and their times under a number, without your name "
    "or address.";

/// Runs of the first seed, by case and method.
using Runs = std::vector<std::pair<std::string, std::map<std::string, ComparisonRow>>>;

Runs first_seeds(const std::vector<ComparisonRow>& rows) {
    Runs runs;
    for (const ComparisonRow& row : rows) {
        auto found = std::find_if(runs.begin(), runs.end(),
                                  [&](const auto& run) { return run.first == row.case_name; });
        if (found == runs.end()) found = runs.insert(found, {row.case_name, {}});
        found->second.emplace(row.method, row);
    }
    return runs;
}

std::vector<std::string> methods_of(const std::vector<ComparisonRow>& rows) {
    std::vector<std::string> methods;
    for (const ComparisonRow& row : rows)
        if (std::find(methods.begin(), methods.end(), row.method) == methods.end())
            methods.push_back(row.method);
    return methods;
}

void keep_whole_cases(Runs& runs, const std::vector<std::string>& methods) {
    std::vector<std::string> lacking;
    std::erase_if(runs, [&](const auto& run) {
        if (run.second.size() == methods.size()) return false;
        lacking.push_back(run.first);
        return true;
    });
    if (!lacking.empty())
        warn(fmt::format("left out because the result of a method is missing: {}",
                         fmt::join(lacking, ", ")));
}

/// Writer of items: assigns ids and copies images under neutral names.
class ItemWriter {
  public:
    ItemWriter(std::uint64_t seed, fs::path folder)
        : random_(seed, RandomStream::study), folder_(std::move(folder)) {
        make_output_folder(folder_);
    }

    StudyItem write(const ComparisonRow& row, StudyItemKind kind, bool unchanged = false) {
        StudyItem item;
        item.id = hidden_name();
        item.kind = kind;
        item.case_name = row.case_name;
        item.method = kind == StudyItemKind::rating ? row.method : "";
        item.from = row.from;
        item.to = row.to;
        item.before = copy(row.folder / "before.png");
        item.after = copy(row.folder / (unchanged ? "before.png" : "after.png"));
        if (!unchanged) item.turntable = copy(row.folder / "turntable.webp");
        if (kind == StudyItemKind::rating) item.scores = row.scores;
        return item;
    }
    Random& random() { return random_; }

  private:
    std::string hidden_name() { return fmt::format("{:016x}", random_.bits()); }
    std::string copy(const fs::path& from) {
        const std::string name = hidden_name() + from.extension().string();
        write_atomically(folder_ / name, read_bytes(from));
        return name;
    }

    Random random_;
    fs::path folder_;
};

void add_practice(Study& study, const Runs& runs, ItemWriter& writer, int count) {
    const auto pick = [&]() -> const ComparisonRow& {
        const auto& run = runs[static_cast<std::size_t>(
            writer.random().index(static_cast<std::int64_t>(runs.size())))];
        const auto method = writer.random().index(static_cast<std::int64_t>(run.second.size()));
        return std::next(run.second.begin(), method)->second;
    };
    if (count > 0) {
        study.items.push_back(writer.write(pick(), StudyItemKind::practice));
        study.items.back().note = "Practice: this answer does not count.";
    }
    if (count > 1) {
        study.items.push_back(writer.write(pick(), StudyItemKind::practice, true));
        study.items.back().note =
            "Practice: this answer does not count. Here the object was not changed: it may look "
            "real and still not match the sentence.";
    }
}

void add_attention(Study& study, const Runs& runs, ItemWriter& writer, int count) {
    for (int i = 0; i < count; ++i) {
        const auto& run = runs[static_cast<std::size_t>(i) % runs.size()].second;
        const auto method = writer.random().index(static_cast<std::int64_t>(run.size()));
        StudyItem item =
            writer.write(std::next(run.begin(), method)->second, StudyItemKind::attention);
        // Two different numbers, so that participants who always choose one fail.
        const auto first = writer.random().index(max_rating);
        const auto second = (first + 1 + writer.random().index(max_rating - 1)) % max_rating;
        item.expected = {min_rating + static_cast<int>(first),
                         min_rating + static_cast<int>(second)};
        study.items.push_back(std::move(item));
    }
}

}  // namespace

Study make_study(const MakeStudyRequest& request) {
    std::vector<std::string> skipped;
    const std::vector<ComparisonRow> rows = read_comparison(request.comparison, skipped);
    for (const std::string& run : skipped)
        warn("no images of " + run);
    const std::string table = (request.comparison / "table.csv").string();
    Study study;
    study.seed = request.seed;
    study.title = request.title;
    study.methods = methods_of(rows);
    if (study.methods.size() < 2)
        throw InputError(table,
                         "has only one method, '" + study.methods.front() +
                             "', but a study compares two or more",
                         "run `item3d compare` with more methods");
    Runs runs = first_seeds(rows);
    keep_whole_cases(runs, study.methods);
    if (runs.empty())
        throw InputError(
            table, "no case has results of all methods",
            "wait until `item3d compare` has ended, or remove failed methods from the table");
    study.consent = request.consent.empty() ? draft_consent : read_text(request.consent);
    make_output_folder(request.output);
    if (fs::exists(request.output / "study.json"))
        throw InputError(request.output.string(), "already contains a study",
                         "choose another folder; answers belong to one study");
    ItemWriter writer(request.seed, request.output / "pictures");
    add_practice(study, runs, writer, request.practice);
    for (const auto& [name, methods] : runs)
        for (const std::string& method : study.methods)
            study.items.push_back(writer.write(methods.at(method), StudyItemKind::rating));
    add_attention(study, runs, writer, request.attention);
    write_study(study, request.output);
    return study;
}

}  // namespace item3d
