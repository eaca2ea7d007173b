// Replacement of files that are updated often while a command runs.
#pragma once

#include <filesystem>
#include <string_view>

namespace item3d {

/// Writes to a temporary name beside `path` and renames, like write_atomically(), but without
/// waiting for the disk: readers always see a complete file, which need not survive a crash of the
/// machine. Throws ResourceError where it cannot be written.
void replace_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace item3d
