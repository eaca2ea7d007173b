#include "item3d/core/csv.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

namespace item3d {
namespace {

/// Throws InputError for a row that is not UTF-8, since rows become JSON, which must be UTF-8.
void check_utf8(const std::vector<std::string>& row, const std::string& subject) {
    try {
        nlohmann::json(row).dump();
    } catch (const nlohmann::json::type_error&) {
        throw InputError(subject, "is not UTF-8", "save it as \"CSV UTF-8\"");
    }
}

}  // namespace

CsvRows parse_csv(const std::string& text, const std::string& subject) {
    CsvRows rows;
    std::vector<std::string> row(1);
    bool quoted = false;
    const auto end_row = [&] {
        if (row.size() > 1 || !row[0].empty()) rows.push_back(row);
        row.assign(1, "");
    };
    for (std::size_t i = text.starts_with("\xef\xbb\xbf") ? 3 : 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            const bool doubled = c == '"' && i + 1 < text.size() && text[i + 1] == '"';
            if (c == '"' && !doubled)
                quoted = false;
            else
                row.back() += c;
            if (doubled) ++i;
        } else if (c == '"' && row.back().empty()) {
            quoted = true;
        } else if (c == ',') {
            row.emplace_back();
        } else if (c == '\n') {
            end_row();
        } else if (c != '\r') {
            row.back() += c;
        }
    }
    if (quoted)
        throw InputError(subject,
                         "a quotation mark is not closed in row " + std::to_string(rows.size() + 1),
                         "write a quotation mark within a field twice");
    end_row();
    return rows;
}

nlohmann::json csv_objects(const CsvRows& rows, const std::string& subject, std::size_t first) {
    nlohmann::json objects = nlohmann::json::array();
    if (!rows.empty()) check_utf8(rows[0], subject + ": header");
    for (std::size_t i = 1; i < rows.size(); ++i) {
        if (rows[i].size() > rows[0].size())
            throw InputError(
                fmt::format("{} {}", subject, first + i - 1),
                fmt::format("has {} fields, but the header has {}", rows[i].size(), rows[0].size()),
                "put fields with a comma in quotation marks");
        check_utf8(rows[i], fmt::format("{} {}", subject, first + i - 1));
        nlohmann::json object = nlohmann::json::object();
        for (std::size_t column = 0; column < rows[i].size(); ++column)
            object[rows[0][column]] = rows[i][column];
        objects.push_back(std::move(object));
    }
    return objects;
}

std::string csv_line(const std::vector<std::string>& fields) {
    std::string line;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (i > 0) line += ',';
        if (fields[i].find_first_of(",\"\r\n") == std::string::npos) {
            line += fields[i];
            continue;
        }
        line += '"';
        for (const char c : fields[i])
            line += c == '"' ? std::string("\"\"") : std::string(1, c);
        line += '"';
    }
    return line + "\n";
}

}  // namespace item3d
