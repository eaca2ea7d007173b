// Parsing of untrusted JSON. nlohmann's parser accepts any depth, for which copies, comparisons and
// dump() exhaust the stack, and it casts integers from any number.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace item3d {

/// Lists and objects in each other; files of ours have 10 at most.
inline constexpr std::size_t max_json_depth = 256;

/// True if lists and objects are nested deeper than max_json_depth.
bool is_too_deep(std::string_view json);

/// Returns a discarded value (is_discarded()) for a text that is not JSON or is too deep.
nlohmann::json parse_json(std::string_view text);
/// Throws nlohmann::json::exception for such a text, with the place.
nlohmann::json parse_json_or_throw(std::string_view text);
/// Keeps the keys in the order of the text.
nlohmann::ordered_json parse_ordered_json_or_throw(std::string_view text);

/// Throws InputError that begins with `subject`, names the line and says what to look for.
nlohmann::json parse_json_text(const std::string& text, const std::string& subject);

/// Returns a whole number, also one written as 3.0. Throws nlohmann::json::exception for others,
/// and for one below `minimum` or above `maximum`.
std::int64_t integer_of(const nlohmann::json& value,
                        std::int64_t minimum = std::numeric_limits<int>::min(),
                        std::int64_t maximum = std::numeric_limits<int>::max());
/// As integer_of().
inline int int_of(const nlohmann::json& value) {
    return static_cast<int>(integer_of(value));
}

}  // namespace item3d
