// Decoding of text files in other encodings than UTF-8. Internal to io.
#pragma once

#include "item3d/core/files.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

bool is_utf8(std::string_view text);

/// Returns the text as UTF-8. UTF-16 and UTF-32 are recognised by their byte order mark or their
/// zeros. For other encodings, tries a list of them and takes the first in which the text contains
/// one of `names` (UTF-8), else Latin-1, and prints the choice. Ignores ASCII names, whose bytes
/// are the same in most encodings. Returns the text unchanged if it contains the bytes of a name
/// that is not UTF-8. subject: name of the file. Throws InputError for text that ends within a
/// character of UTF-16 or UTF-32.
std::string decode_text(std::string_view bytes, const std::vector<std::string>& names,
                        const std::string& subject);

/// Returns the names of the files and folders below `folder`, up to some thousand.
std::vector<std::string> names_below(const std::filesystem::path& folder);

}  // namespace item3d
