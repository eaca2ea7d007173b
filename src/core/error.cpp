#include "item3d/core/error.h"

namespace item3d {

void check_failed(const char* expression, const char* file, int line, const std::string& detail) {
    throw std::logic_error(std::string(file) + ":" + std::to_string(line) +
                           ": check failed: " + expression + ": " + detail);
}

}  // namespace item3d
