// Parsing of untrusted JSON. The parser of the library nlohmann/json accepts any depth of nesting,
// but copies, comparisons and dump() of a deep value exhaust the stack. The library's get()
// converts any number to an integer without a check of its range.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace item3d {

/// Maximum depth of nested lists and objects; files that this program writes have a depth of at
/// most 10.
inline constexpr std::size_t max_json_depth = 256;

/// True if lists and objects are nested deeper than max_json_depth.
bool is_too_deep(std::string_view json);

/// Returns a discarded value (is_discarded()) for a text that is not JSON or is too deep.
nlohmann::json parse_json(std::string_view text);
/// Parses JSON. Throws nlohmann::json::exception, with the position, for a text that is not JSON or
/// is too deep.
nlohmann::json parse_json_or_throw(std::string_view text);
/// Parses JSON as parse_json_or_throw() does, and keeps the order of the keys.
nlohmann::ordered_json parse_ordered_json_or_throw(std::string_view text);

/// Parses JSON. Throws InputError that begins with `subject`, names the line and advises on the
/// error.
nlohmann::json parse_json_text(const std::string& text, const std::string& subject);

/// Returns a whole number, which may be written as 3.0. Throws nlohmann::json::exception for any
/// other value, and for a number below `minimum` or above `maximum`.
std::int64_t integer_of(const nlohmann::json& value,
                        std::int64_t minimum = std::numeric_limits<int>::min(),
                        std::int64_t maximum = std::numeric_limits<int>::max());
/// Returns integer_of() for an int.
inline int int_of(const nlohmann::json& value) {
    return static_cast<int>(integer_of(value));
}

}  // namespace item3d
