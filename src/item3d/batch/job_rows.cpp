#include "item3d/batch/job_rows.h"

#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"

#include <glob.h>

#include <algorithm>
#include <sstream>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* row_example =
    R"(as in {"model": "mug.glb", "from": "a red mug", "to": "a golden mug"})";

bool is_empty(const json& value) {
    return value.is_null() ||
           (value.is_string() &&
            value.get_ref<const std::string&>().find_first_not_of(" \t") == std::string::npos);
}

JobRow row_of(const json& values, const fs::path& file, std::string place) {
    if (!values.is_object()) throw InputError(place, "expected an object", row_example);
    JobRow row{json::object(), fs::absolute(file).parent_path(), std::move(place)};
    for (const auto& [column, value] : values.items())
        if (!is_empty(value)) row.values[column] = value;
    return row;
}

std::vector<JobRow> rows_of_lines(const std::string& text, const fs::path& file) {
    std::vector<JobRow> rows;
    std::istringstream lines(text);
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        const std::string place = fmt::format("{}: line {}", file.string(), number);
        const json values = parse_json(line);
        if (values.is_discarded())
            throw InputError(place, "is not valid JSON",
                             "expected one JSON object per line, or a file that ends in .csv");
        rows.push_back(row_of(values, file, place));
    }
    return rows;
}

/// Returns the matching files, sorted by name.
std::vector<std::string> files_of(const std::string& pattern) {
    if (pattern.find_first_of("*?[") == std::string::npos) return {pattern};
    glob_t found{};
    const int code = ::glob(pattern.c_str(), 0, nullptr, &found);
    std::vector<std::string> files;
    for (std::size_t i = 0; code == 0 && i < found.gl_pathc; ++i)
        files.emplace_back(found.gl_pathv[i]);
    ::globfree(&found);
    if (files.empty())
        throw InputError("--models " + pattern, "no file matches", "check the pattern");
    return files;
}

using Axis = std::pair<std::string, std::vector<std::string>>;

std::vector<Axis> axes_of(const std::vector<std::string>& values) {
    std::vector<Axis> axes;
    for (const std::string& text : values) {
        const std::size_t split = text.find('=');
        if (split == std::string::npos || split == 0)
            throw UsageError("--with " + text + ": expected NAME=VALUE, as in iterations=100");
        const std::string name = text.substr(0, split);
        const auto found = std::find_if(axes.begin(), axes.end(),
                                        [&](const Axis& axis) { return axis.first == name; });
        if (found == axes.end())
            axes.push_back({name, {text.substr(split + 1)}});
        else
            found->second.push_back(text.substr(split + 1));
    }
    return axes;
}

}  // namespace

std::vector<JobRow> read_job_rows(const fs::path& file) {
    const std::string text = read_text(file);
    std::vector<JobRow> rows;
    const auto add = [&](const json& entries, std::size_t first) {
        for (const json& entry : entries)
            rows.push_back(
                row_of(entry, file, fmt::format("{}: row {}", file.string(), first + rows.size())));
    };
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (file.extension() == ".csv") {
        const CsvRows table = parse_csv(text, file.string());
        // Rows are numbered as in a spreadsheet, whose first row is the header.
        constexpr std::size_t below_header = 2;
        if (!table.empty())
            add(csv_objects(table, file.string() + ": row", below_header), below_header);
    } else if (first != std::string::npos && text[first] == '[') {
        const json list = parse_json(text);
        if (list.is_discarded())
            throw InputError(file.string(), "is not valid JSON", "expected a list of jobs");
        add(list, 1);
    } else {
        rows = rows_of_lines(text, file);
    }
    if (rows.empty()) throw InputError(file.string(), "contains no jobs", row_example);
    return rows;
}

std::vector<JobRow> matrix_rows(const JobMatrix& matrix) {
    if (matrix.from.size() != 1 && matrix.from.size() != matrix.to.size())
        throw UsageError(fmt::format(
            "--from is given {} times and --to {} times; give --from once, or as often as --to",
            matrix.from.size(), matrix.to.size()));
    std::vector<JobRow> rows;
    for (const std::string& pattern : matrix.models)
        for (const std::string& model : files_of(pattern))
            for (std::size_t i = 0; i < matrix.to.size(); ++i) {
                const std::string& from = matrix.from[matrix.from.size() == 1 ? 0 : i];
                rows.push_back({{{"model", model}, {"from", from}, {"to", matrix.to[i]}},
                                fs::current_path(),
                                fmt::format("{}: {}", model, matrix.to[i])});
            }
    return rows;
}

std::vector<JobRow> with_values(const std::vector<JobRow>& rows,
                                const std::vector<std::string>& values) {
    std::vector<JobRow> result = rows;
    for (const auto& [name, choices] : axes_of(values)) {
        std::vector<JobRow> longer;
        for (const JobRow& row : result) {
            if (choices.size() > 1 && (row.values.contains("name") || row.values.contains("after")))
                throw UsageError(row.place + ": has a name or an `after`, and " + name +
                                 " has several values; leave out one of them");
            for (const std::string& choice : choices) {
                JobRow next = row;
                next.values[name] = choice;
                if (choices.size() > 1) next.place += fmt::format(" ({} {})", name, choice);
                longer.push_back(std::move(next));
            }
        }
        result = std::move(longer);
    }
    return result;
}

}  // namespace item3d
