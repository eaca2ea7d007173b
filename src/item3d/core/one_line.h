// Text for terminals: names from files can contain control characters.
#pragma once

#include <string>
#include <string_view>

namespace item3d {

/// Returns the text on one line: line breaks become spaces, and other control characters become
/// escapes such as \x1b. Otherwise a name in a file could move the cursor, clear the screen or add
/// a line that looks like another message. Bytes that are not UTF-8 stay as they are.
std::string one_line(std::string_view text);

}  // namespace item3d
