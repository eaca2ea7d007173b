#include "item3d/core/error.h"

namespace item3d {

void check_failed(const char* expression, const char* file, int line, const std::string& detail) {
    // The part of the path before the sources' folder is removed, because it depends on the
    // machine.
    const std::string path = file;
    const std::size_t own = path.rfind("item3d/");
    const std::string shown = own == std::string::npos ? path : path.substr(own);
    throw std::logic_error(shown + ":" + std::to_string(line) + ": check failed: " + expression +
                           ": " + detail);
}

}  // namespace item3d
