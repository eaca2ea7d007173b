// Files of the running program and of what it starts.
#pragma once

#include <filesystem>

namespace item3d {

/// The running program's file. /proc/self/exe would be the dynamic loader where a package starts a
/// program by its own one. Throws ResourceError without /proc.
std::filesystem::path running_program();

/// The folder of item3d-edit and the other families, as they are to be started: the running
/// program's, or, in a package, the one above it (apps/item3d/launcher).
std::filesystem::path programs_folder();

/// `item3d`, which runs any command: in programs_folder() of a build, in ../../bin from there when
/// installed. Throws ResourceError where it is not there.
std::filesystem::path launcher_program();

}  // namespace item3d
