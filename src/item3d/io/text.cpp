#include "item3d/io/text.h"

#include "item3d/io/encoding.h"

#include <cctype>
#include <charconv>
#include <cstdlib>

namespace item3d {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r';
}

}  // namespace

LineReader::LineReader(std::string_view text) : text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
}

std::string_view LineReader::physical_line() {
    const std::size_t end = text_.find_first_of("\r\n", offset_);
    const std::size_t begin = offset_;
    if (end == std::string_view::npos) {
        offset_ = text_.size();
    } else {
        const bool is_crlf = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
        offset_ = end + (is_crlf ? 2 : 1);
    }
    ++lines_read_;
    return text_.substr(begin, (end == std::string_view::npos ? text_.size() : end) - begin);
}

bool LineReader::next(std::string_view& line) {
    if (offset_ >= text_.size()) return false;
    line = physical_line();
    first_line_ = lines_read_;
    if (line.empty() || line.back() != '\\') return true;
    joined_.clear();
    while (!line.empty() && line.back() == '\\') {
        joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
        line = offset_ < text_.size() ? physical_line() : std::string_view();
    }
    joined_.append(line);
    line = joined_;
    return true;
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

std::string_view take_word(std::string_view& text) {
    while (!text.empty() && is_blank(text.front()))
        text.remove_prefix(1);
    std::size_t length = 0;
    while (length < text.size() && !is_blank(text[length]))
        ++length;
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length);
    return word;
}

std::optional<double> parse_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
    // from_chars leaves the value unset when it is out of range; strtod distinguishes 0 from
    // infinity.
    if (error == std::errc::result_out_of_range)
        return std::strtod(std::string(word).c_str(), nullptr);
    return value;
}

std::string to_lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::string to_utf8(std::string_view text) {
    if (is_utf8(text)) return std::string(text);
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            result.push_back(c);
        } else {
            result.push_back(static_cast<char>(0xc0 | byte >> 6));
            result.push_back(static_cast<char>(0x80 | (byte & 0x3f)));
        }
    }
    return result;
}

}  // namespace item3d
