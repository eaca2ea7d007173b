// Small helpers for the text formats (OBJ, MTL). Internal to io.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace item3d {

/// Walks through the logical lines of a text: LF, CRLF or CR ends, backslash continuations joined,
/// a byte order mark skipped.
class LineReader {
  public:
    explicit LineReader(std::string_view text);
    /// False at the end. The view is valid until the next call.
    bool next(std::string_view& line);
    /// Number of the first physical line of the logical line that next() gave, from 1.
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
/// Takes the first word off `text` (blanks and tabs part words); empty when there is none.
std::string_view take_word(std::string_view& text);
/// "1.5", "+.5", "1e-3", "-2."; values too small become 0, too large infinity. The whole word must
/// be a number.
std::optional<double> parse_number(std::string_view word);
std::string to_lower(std::string_view text);
/// The text itself when it is UTF-8, else its bytes taken as Latin-1.
std::string to_utf8(std::string_view text);

}  // namespace item3d
