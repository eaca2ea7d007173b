// Text files of other encodings than UTF-8. Internal to io.
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

bool is_utf8(std::string_view text);

/// The text as UTF-8. UTF-16 and UTF-32 are told by their byte order mark or their zeros. Of other
/// encodings the first is taken in which the text holds one of `names` (UTF-8; those in ASCII are
/// no help), else Latin-1; a note says which. Text that holds a name byte by byte, whatever
/// its encoding, stays as it is. `subject` names the file. Throws InputError for text that ends
/// within a character of UTF-16 or UTF-32.
std::string decode_text(std::string_view bytes, const std::vector<std::string>& names,
                        const std::string& subject);

/// Names of the files and folders in `folder` and below, at most some thousand.
std::vector<std::string> names_below(const std::filesystem::path& folder);

}  // namespace item3d
