// Tables of values separated by commas (RFC 4180).
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

using CsvRows = std::vector<std::vector<std::string>>;

/// Rows of fields; a quoted field may hold commas, line ends and doubled quotes. Lines without
/// anything are left out, as is a byte order mark. Throws InputError that names `subject` where a
/// quote is not closed.
CsvRows parse_csv(const std::string& text, const std::string& subject);

/// Rows below a header as a list of JSON objects of texts, with the header's fields as keys. Throws
/// InputError that names the row ("SUBJECT 3") where it has more fields than the header or is not
/// UTF-8. first: number of the first of these rows.
nlohmann::json csv_objects(const CsvRows& rows, const std::string& subject, std::size_t first = 1);

/// One row with its line end; fields are quoted where they must be.
std::string csv_line(const std::vector<std::string>& fields);

}  // namespace item3d
