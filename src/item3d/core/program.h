// Locations of the running program and of the programs that it starts.
#pragma once

#include <filesystem>

namespace item3d {

/// Returns the running program's file. /proc/self/exe would be the dynamic loader where a package
/// starts a program by its own loader. Throws ResourceError without /proc.
std::filesystem::path running_program();

/// Returns the folder of item3d-edit and the other programs: the running program's, or, in a
/// package, its parent (apps/item3d/launcher).
std::filesystem::path programs_folder();

/// Returns `item3d`, which runs any command: in programs_folder() of a build, in ../../bin from
/// there when installed. Throws ResourceError where it is missing.
std::filesystem::path launcher_program();

}  // namespace item3d
