// Names of files as people's files spell them. Internal to io.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// What a name that is no file may have been meant as, the likeliest first: percent-decoded (also
/// twice), without what follows a question mark or number sign; each also by its last part alone,
/// since exporters write paths of the machine that they ran on.
std::vector<std::string> other_spellings(const std::string& name);

/// The regular file below `root` that `name` means with either separator, in any case of letters
/// and any normalization of Unicode; bytes that are not UTF-8 are taken as Latin-1. No value where
/// there is none, or where it lies outside of `root` (by "..", or by a link).
std::optional<std::filesystem::path> find_file_below(const std::filesystem::path& root,
                                                     std::string_view name);

std::string percent_decode(std::string_view text);

}  // namespace item3d
