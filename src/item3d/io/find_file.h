// Lookup of files by inexact names, as other programs' files spell them. Internal to io.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Returns possible spellings of a file name that does not exist, the likeliest first:
/// percent-decoded once or twice, and without a query or fragment. After these come their last
/// components alone, since exporters write paths of their own machine.
std::vector<std::string> other_spellings(const std::string& name);

/// Returns the regular file below `root` that `name` denotes with either separator, ignoring case
/// and Unicode normalization; bytes that are not UTF-8 count as Latin-1. No value where there is
/// none, or where it lies outside of `root` (by "..", or by a link).
std::optional<std::filesystem::path> find_file_below(const std::filesystem::path& root,
                                                     std::string_view name);

std::string percent_decode(std::string_view text);

}  // namespace item3d
