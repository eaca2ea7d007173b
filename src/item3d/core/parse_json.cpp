#include "item3d/core/parse_json.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace item3d {
namespace {

/// Replacement for a text that is nested too deeply. It is not JSON, so the parser refuses it.
constexpr std::string_view too_deep = "nested too deeply";

std::string_view depth_checked(std::string_view text) {
    return is_too_deep(text) ? too_deep : text;
}

/// Returns the word or sign at which a parser stopped after reading `end` bytes.
std::string_view word_before(std::string_view text, std::size_t end) {
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    end = std::min(end, text.size());
    std::size_t begin = end > 0 ? end - 1 : 0;
    while (begin > 0 && is_word(text[begin - 1]))
        --begin;
    while (end < text.size() && is_word(text[end]))
        ++end;
    return text.substr(begin, end - begin);
}

std::string advice(std::string_view text, std::size_t byte) {
    const std::string_view word = word_before(text, byte);
    if (word.find("NaN") != std::string_view::npos ||
        word.find("Infinity") != std::string_view::npos)
        return "NaN and Infinity are not valid in JSON; write a number";
    if (text.substr(0, 2) == "\xff\xfe" || text.substr(0, 2) == "\xfe\xff")
        return "save it as UTF-8 instead of UTF-16";
    return "look for a missing or extra comma, quotation mark or bracket";
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

nlohmann::json parse_json_text(const std::string& text, const std::string& subject) {
    if (is_too_deep(text)) throw InputError(subject, "its JSON is nested too deeply", "flatten it");
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        const std::size_t byte = std::min(error.byte, text.size());
        const auto lines =
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(byte), '\n');
        throw InputError(subject, fmt::format("is not valid JSON, see line {}", lines),
                         advice(text, byte));
    } catch (const nlohmann::json::out_of_range&) {
        throw InputError(subject, "contains a number that is too large for a double",
                         "the limit is 1.8e308");
    }
}

std::int64_t integer_of(const nlohmann::json& value, std::int64_t minimum, std::int64_t maximum) {
    const auto refuse = [&] {
        throw nlohmann::json::out_of_range::create(
            403, "expected an integer in the allowed range, found " + value.dump(-1, ' ', true),
            nullptr);
    };
    if (!value.is_number()) refuse();
    // The conversion to double is exact below 2^53. Larger integers are rounded to integers.
    const double number = value.get<double>();
    constexpr double highest = 9.2e18;
    if (!(std::abs(number) < highest) || number != std::floor(number)) refuse();
    const auto integer =
        value.is_number_float() ? static_cast<std::int64_t>(number) : value.get<std::int64_t>();
    if (integer < minimum || integer > maximum) refuse();
    return integer;
}

}  // namespace item3d
