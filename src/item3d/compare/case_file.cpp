#include "item3d/compare/case_file.h"

#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace item3d {
namespace {

constexpr const char* list_example =
    R"(as in [{"model": "mug.glb", "from": "a red mug", "to": "a golden mug"}])";

std::string without_underscores(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

void refuse_repeated_columns(const std::vector<std::string>& header, const std::string& subject) {
    std::map<std::string, std::size_t> columns;
    for (std::size_t i = 0; i < header.size(); ++i) {
        const auto [first, is_new] = columns.emplace(without_underscores(header[i]), i);
        if (!is_new)
            throw InputError(subject,
                             fmt::format("columns {} and {} are both '{}'", first->second + 1,
                                         i + 1, first->first),
                             "leave one of them out");
    }
}

nlohmann::json rows_of_csv(const std::string& text, const std::string& subject) {
    const CsvRows rows = parse_csv(text, subject);
    if (rows.size() < 2)
        throw InputError(subject, rows.empty() ? "is empty" : "has no rows below its header",
                         "expected a header such as model,from,to, and a row for each case");
    refuse_repeated_columns(rows.front(), subject);
    return csv_objects(rows, subject + ": case");
}

void refuse_other_bytes(const std::string& text, const std::string& subject) {
    try {
        nlohmann::json(text).dump();
    } catch (const nlohmann::json::type_error&) {
        throw InputError(subject, "is not UTF-8", "save it as UTF-8");
    }
}

/// Returns the place, as "line 3, column 5", in a parser's message "... at line 3, column 5: ...".
std::string place_in(const std::string& message) {
    const std::size_t begin = message.find("line ");
    return begin == std::string::npos ? "nested too deeply"
                                      : message.substr(begin, message.find(':', begin) - begin);
}

nlohmann::json list_of_json(const std::string& text, const std::string& subject) {
    using Event = nlohmann::json::parse_event_t;
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InputError(subject, "is empty", list_example);
    refuse_other_bytes(text, subject);
    if (is_too_deep(text)) throw InputError(subject, "is nested too deeply", list_example);
    std::size_t number = 0;
    std::set<std::string> keys;
    const auto refuse_repeated_keys = [&](int depth, Event event, nlohmann::json& parsed) {
        if (depth == 1 && (event == Event::object_start || event == Event::value)) {
            ++number;
            keys.clear();
        }
        if (depth == 2 && event == Event::key &&
            !keys.insert(without_underscores(parsed.get<std::string>())).second)
            throw InputError(fmt::format("{}: case {}", subject, number),
                             "gives '" + parsed.get<std::string>() + "' twice",
                             "leave one of them out");
        return true;
    };
    try {
        return nlohmann::json::parse(text, refuse_repeated_keys);
    } catch (const nlohmann::json::exception& error) {
        throw InputError(subject, "is not valid JSON: " + place_in(error.what()),
                         "expected a list of cases, or a file that ends in .csv");
    }
}

}  // namespace

nlohmann::json read_case_entries(const std::filesystem::path& file) {
    const std::string text = read_text(file);
    const std::string subject = file.string();
    nlohmann::json entries =
        file.extension() == ".csv" ? rows_of_csv(text, subject) : list_of_json(text, subject);
    if (!entries.is_array() || entries.empty())
        throw InputError(subject, "expected a list of cases", list_example);
    return entries;
}

}  // namespace item3d
