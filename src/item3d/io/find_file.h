// Lookup of files by the inexact names that other programs write.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// Returns other spellings of the name of a file that was not found, the likeliest first:
/// percent-decoded once or twice, and without a query or fragment. The last components of these
/// names follow, since exporters write paths of their own machine.
std::vector<std::string> other_spellings(const std::string& name);

/// Returns the regular file below `root` that `name` denotes. `name` may have either separator;
/// case and Unicode normalization are ignored; bytes that are not UTF-8 count as Latin-1. Returns
/// no value if there is no such file, or if it lies outside of `root` (by "..", or by a link).
std::optional<std::filesystem::path> find_file_below(const std::filesystem::path& root,
                                                     std::string_view name);

std::string percent_decode(std::string_view text);

}  // namespace item3d
