#include "item3d/core/error.h"

#include <filesystem>
#include <system_error>

namespace item3d {

std::string message_of(const std::exception& error) {
    const auto* system = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
    if (!system || system->path1().empty()) return error.what();
    const char* remedy = system->code() == std::errc::no_space_on_device
                             ? "free some space"
                             : "check the path and its permissions";
    return system->path1().string() + ": " + system->code().message() + "; " + remedy;
}

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
