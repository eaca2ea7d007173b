// Locations of the running program and of the programs that it starts.
#pragma once

#include <filesystem>

namespace item3d {

/// Returns the running program's file. Does not read /proc/self/exe, which names the dynamic loader
/// in packages that start their programs through a loader of their own. Throws ResourceError if
/// there is no /proc.
std::filesystem::path running_program();

/// Returns the folder of item3d-edit and the other programs. It is the folder of the running
/// program, or, in a package, the parent of that folder (apps/item3d/launcher).
std::filesystem::path programs_folder();

/// Returns the path of the program `item3d`, which runs every command. It is in programs_folder()
/// after a build, and in ../../bin relative to that folder after an installation. Throws
/// ResourceError if it is missing.
std::filesystem::path launcher_program();

}  // namespace item3d
