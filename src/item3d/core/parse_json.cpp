#include "item3d/core/parse_json.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/json_text.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace item3d {
namespace {

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

}  // namespace item3d
