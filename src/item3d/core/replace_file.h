// Files that are renewed all the time while a command works.
#pragma once

#include <filesystem>
#include <string_view>

namespace item3d {

/// Writes to a temporary name beside `path` and renames, as write_atomically() does, but does not
/// wait until the bytes are on the disk: readers see a whole file, and after a crash of the machine
/// nobody wants it. Throws ResourceError where it cannot be written.
void replace_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace item3d
