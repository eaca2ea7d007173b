#include "item3d/study/make_study.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/io/encoding.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/scene/image.h"
#include "item3d/study/comparison_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
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

/// Runs of one seed, by case and method.
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

/// Returns runs for practice. Their seeds are not rated. If there are no such runs, returns the
/// rated runs.
std::vector<const ComparisonRow*> practice_rows(const std::vector<ComparisonRow>& rows,
                                                const Runs& rated) {
    std::vector<const ComparisonRow*> others, all;
    for (const ComparisonRow& row : rows) {
        const auto run = std::find_if(rated.begin(), rated.end(),
                                      [&](const auto& one) { return one.first == row.case_name; });
        if (run == rated.end()) continue;
        all.push_back(&row);
        if (run->second.at(row.method).seed != row.seed) others.push_back(&row);
    }
    return others.empty() ? all : others;
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

constexpr const char* broken_run_hint =
    "delete the folder of that run, and let `item3d compare` run it again";

/// True if the file has as many bytes as its RIFF header says.
bool is_whole_webp(const Bytes& bytes) {
    constexpr std::size_t header = 12;
    if (bytes.size() < header || std::memcmp(bytes.data(), "RIFF", 4) != 0 ||
        std::memcmp(bytes.data() + 8, "WEBP", 4) != 0)
        return false;
    std::size_t size = 0;
    for (int i = 3; i >= 0; --i)
        size = size << 8 | bytes[static_cast<std::size_t>(4 + i)];
    return bytes.size() >= size + 8;
}

/// Returns a contact sheet without its title. Removes the rows above the first row that mostly has
/// other colours than the background, except for a gap as wide as on the other sides.
Image without_title(Image sheet) {
    constexpr int gap = 12;
    const auto differs = [&](int x, int y) {
        for (int c = 0; c < sheet.channels; ++c)
            if (sheet.at(x, y, c) != sheet.at(0, 0, c)) return true;
        return false;
    };
    const auto is_of_views = [&](int y) {
        int count = 0;
        for (int x = 0; x < sheet.width; ++x)
            count += differs(x, y);
        return 2 * count > sheet.width;
    };
    int first = 0;
    while (first < sheet.height && !is_of_views(first))
        ++first;
    const int top = first - gap;
    if (first == sheet.height || top <= 0) return sheet;
    const auto row =
        static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.channels);
    sheet.pixels.erase(sheet.pixels.begin(),
                       sheet.pixels.begin() + static_cast<std::ptrdiff_t>(row) * top);
    sheet.height -= top;
    return sheet;
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
        item.before = write_views(row.folder / "before.png");
        item.after = write_views(row.folder / (unchanged ? "before.png" : "after.png"));
        if (!unchanged) item.turntable = copy(row.folder / "turntable.webp");
        if (kind == StudyItemKind::rating) item.scores = row.scores;
        return item;
    }
    Random& random() { return random_; }

  private:
    std::string hidden_name() { return fmt::format("{:016x}", random_.bits()); }
    /// Writes a sheet of views without its title. The title would tell what the edit should show.
    std::string write_views(const fs::path& sheet) {
        const std::string name = hidden_name() + ".png";
        save_image(folder_ / name, without_title(load_image(sheet)));
        return name;
    }
    std::string copy(const fs::path& from) {
        const std::string name = hidden_name() + from.extension().string();
        const Bytes bytes = read_bytes(from);
        if (!is_whole_webp(bytes))
            throw InputError(from.string(), "is not a complete WebP image", broken_run_hint);
        write_atomically(folder_ / name, bytes);
        return name;
    }

    Random random_;
    fs::path folder_;
};

void add_practice(Study& study, const std::vector<const ComparisonRow*>& rows, ItemWriter& writer,
                  int count) {
    const auto pick = [&]() -> const ComparisonRow& {
        return *rows[static_cast<std::size_t>(
            writer.random().index(static_cast<std::int64_t>(rows.size())))];
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

/// Draws two different numbers, so that participants who always choose the same number fail.
StudyAnswer draw_expected(Random& random) {
    const auto first = random.index(max_rating);
    const auto second = (first + 1 + random.index(max_rating - 1)) % max_rating;
    return {min_rating + static_cast<int>(first), min_rating + static_cast<int>(second)};
}

void add_attention(Study& study, const Runs& runs, ItemWriter& writer, int count) {
    for (int i = 0; i < count; ++i) {
        const auto& run = runs[static_cast<std::size_t>(i) % runs.size()].second;
        const auto method = writer.random().index(static_cast<std::int64_t>(run.size()));
        StudyItem item =
            writer.write(std::next(run.begin(), method)->second, StudyItemKind::attention);
        do
            item.expected = draw_expected(writer.random());
        while (i > 0 && study.items.back().expected == item.expected);
        study.items.push_back(std::move(item));
    }
}

/// Returns the file's text, or the draft if there is no file.
std::string consent_text(const fs::path& file) {
    if (file.empty()) return draft_consent;
    std::string text = read_text(file);
    if (!is_utf8(text)) throw InputError(file.string(), "is not UTF-8", "save it as UTF-8");
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InputError(file.string(), "is empty, and participants must know what they agree to",
                         "write a text, or leave --consent out to use the draft");
    return text;
}

void check_title(const std::string& title) {
    if (!is_utf8(title)) throw InputError("--title", "is not UTF-8", "use a UTF-8 terminal");
    if (title.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InputError("--title", "is empty", "leave it out for the default");
}

}  // namespace

Study make_study(const MakeStudyRequest& request) {
    check_title(request.title);
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
    study.consent = consent_text(request.consent);
    make_output_folder(request.output);
    if (fs::exists(request.output / "study.json"))
        throw InputError(request.output.string(), "already contains a study",
                         "choose another folder; answers belong to one study");
    const fs::path images = request.output / "pictures";
    try {
        ItemWriter writer(request.seed, images);
        add_practice(study, practice_rows(rows, runs), writer, request.practice);
        for (const auto& [name, methods] : runs)
            for (const std::string& method : study.methods)
                study.items.push_back(writer.write(methods.at(method), StudyItemKind::rating));
        add_attention(study, runs, writer, request.attention);
        write_study(study, request.output);
    } catch (const Error&) {
        std::error_code code;
        fs::remove_all(images, code);
        throw;
    }
    return study;
}

}  // namespace item3d
