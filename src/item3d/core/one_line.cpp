#include "item3d/core/one_line.h"

#include <cstdio>

namespace item3d {
namespace {

constexpr unsigned char delete_character = 0x7f;

/// True for the second byte of a control character U+0080 to U+009F.
bool ends_control(std::string_view text, std::size_t i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    return i > 0 && text[i - 1] == '\xc2' && byte >= 0x80 && byte <= 0x9f;
}

void append_escape(std::string& line, unsigned char byte) {
    char escape[8];
    std::snprintf(escape, sizeof(escape), "\\x%02x", byte);
    line += escape;
}

}  // namespace

std::string one_line(std::string_view text) {
    std::string line;
    line.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte == '\n' || byte == '\r') {
            line += ' ';
        } else if (byte < ' ' || byte == delete_character) {
            append_escape(line, byte);
        } else if (ends_control(text, i)) {
            line.pop_back();
            append_escape(line, byte);
        } else {
            line += text[i];
        }
    }
    return line;
}

}  // namespace item3d
