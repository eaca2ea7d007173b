// Comma-separated tables (RFC 4180).
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

using CsvRows = std::vector<std::vector<std::string>>;

/// Parses a table into rows of fields. A quoted field may contain commas, line ends and doubled
/// quotes. Skips empty lines and a byte order mark. Throws InputError that names `subject` for an
/// unclosed quote.
CsvRows parse_csv(const std::string& text, const std::string& subject);

/// Returns the rows after a header as a list of JSON objects of strings, with the header's fields
/// as keys. Throws InputError that names the row ("SUBJECT 3") if a row has more fields than the
/// header or is not UTF-8. first: number of the first row after the header.
nlohmann::json csv_objects(const CsvRows& rows, const std::string& subject, std::size_t first = 1);

/// Returns one row as a line of text, with its line end. Fields are quoted if necessary.
std::string csv_line(const std::vector<std::string>& fields);

}  // namespace item3d
