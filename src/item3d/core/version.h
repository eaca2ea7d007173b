// The version of this build, as CMakeLists.txt says it.
#pragma once

#include <string>

namespace item3d {

/// "0.1.0".
std::string version();

}  // namespace item3d
