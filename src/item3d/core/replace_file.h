// Replacement of files that are updated often while a command runs.
#pragma once

#include <filesystem>
#include <string_view>

namespace item3d {

/// Writes a file under a temporary name beside `path` and renames it, like write_atomically(), but
/// does not wait for the disk. Readers always see a complete file, but a crash of the machine may
/// lose it. Throws ResourceError if the file cannot be written.
void replace_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace item3d
