// Helpers for the text formats (OBJ, MTL). Internal to io.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace item3d {

/// Iterates over the logical lines of a text. Lines end with LF, CRLF or CR. A line that a
/// backslash continues is joined with the next. A byte order mark is skipped.
class LineReader {
  public:
    explicit LineReader(std::string_view text);
    /// Returns false at the end. The view is valid until the next call.
    bool next(std::string_view& line);
    /// Returns the number of the current logical line's first physical line, from 1.
    int line_number() const { return first_line_; }

  private:
    std::string_view physical_line();

    std::string_view text_;
    std::size_t offset_ = 0;
    int lines_read_ = 0;
    int first_line_ = 0;
    std::string joined_;
};

std::string_view trim(std::string_view text);
/// Removes and returns the first word of `text` (separated by blanks and tabs); empty when there is
/// none.
std::string_view take_word(std::string_view& text);
/// Parses "1.5", "+.5", "1e-3", "-2."; underflow gives 0, and overflow gives infinity. The whole
/// word must be a number.
std::optional<double> parse_number(std::string_view word);
std::string to_lower(std::string_view text);
/// Returns the text itself if it is UTF-8, else its bytes converted from Latin-1.
std::string to_utf8(std::string_view text);

}  // namespace item3d
