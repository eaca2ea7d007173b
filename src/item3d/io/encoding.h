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
/// zero bytes. For a text in another encoding, the function tries a list of encodings, takes the
/// first in which the text contains one of `names` (UTF-8), or Latin-1 if there is none, and prints
/// the choice. It ignores ASCII names, whose bytes are the same in most encodings. The text is
/// returned unchanged if it contains the bytes of one of `names` that is not UTF-8. subject: name
/// of the file. Throws InputError for text that ends within a character of UTF-16 or UTF-32.
std::string decode_text(std::string_view bytes, const std::vector<std::string>& names,
                        const std::string& subject);

/// Returns the names of the files and folders below `folder`, at most a few thousand.
std::vector<std::string> names_below(const std::filesystem::path& folder);

}  // namespace item3d
