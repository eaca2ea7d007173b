// Protection of special files against a command's output.
#pragma once

#include <filesystem>

namespace item3d {

/// Throws InputError if the path exists and is neither a regular file nor a folder. A device or a
/// pipe would otherwise be replaced by a file.
void check_replaceable(const std::filesystem::path& path);

}  // namespace item3d
