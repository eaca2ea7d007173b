// The version of this build, from CMakeLists.txt.
#pragma once

#include <string>

namespace item3d {

/// Returns the version, such as "0.2.0".
std::string version();

}  // namespace item3d
