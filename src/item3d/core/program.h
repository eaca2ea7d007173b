// Files of the running program and of what it starts.
#pragma once

#include <filesystem>

namespace item3d {

/// The running program's file. /proc/self/exe would be the dynamic loader where a package starts a
/// program by its own one. Throws ResourceError without /proc.
std::filesystem::path running_program();

/// `item3d`, which runs any command: beside the running program in a build folder, in ../../bin
/// when installed. Throws ResourceError where it is not there.
std::filesystem::path launcher_program();

}  // namespace item3d
