#include "item3d/core/json_text.h"

#include <cmath>

namespace item3d {
namespace {

/// Replacement for a text that is nested too deeply. It is not JSON, so the parser refuses it.
constexpr std::string_view too_deep = "nested too deeply";

std::string_view depth_checked(std::string_view text) {
    return is_too_deep(text) ? too_deep : text;
}

}  // namespace

bool is_too_deep(std::string_view json) {
    std::size_t depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string && c == '\\') {
            ++i;
        } else if (c == '"') {
            in_string = !in_string;
        } else if (!in_string && (c == '[' || c == '{')) {
            if (++depth > max_json_depth) return true;
        } else if (!in_string && (c == ']' || c == '}') && depth > 0) {
            --depth;
        }
    }
    return false;
}

nlohmann::json parse_json(std::string_view text) {
    return nlohmann::json::parse(depth_checked(text), nullptr, /*allow_exceptions=*/false);
}

nlohmann::json parse_json_or_throw(std::string_view text) {
    return nlohmann::json::parse(depth_checked(text));
}

nlohmann::ordered_json parse_ordered_json_or_throw(std::string_view text) {
    return nlohmann::ordered_json::parse(depth_checked(text));
}

std::int64_t integer_of(const nlohmann::json& value, std::int64_t minimum, std::int64_t maximum) {
    const auto refuse = [&] {
        throw nlohmann::json::out_of_range::create(
            403, "expected an integer in the allowed range, found " + value.dump(-1, ' ', true),
            nullptr);
    };
    if (!value.is_number()) refuse();
    // Exact below 2^53, and beyond it no less than the number.
    const double number = value.get<double>();
    constexpr double highest = 9.2e18;
    if (!(std::abs(number) < highest) || number != std::floor(number)) refuse();
    const auto integer =
        value.is_number_float() ? static_cast<std::int64_t>(number) : value.get<std::int64_t>();
    if (integer < minimum || integer > maximum) refuse();
    return integer;
}

}  // namespace item3d
