#include "item3d/core/program.h"

#include "item3d/core/error.h"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

namespace item3d {

namespace fs = std::filesystem;

fs::path running_program() {
    const auto here = reinterpret_cast<std::uintptr_t>(&running_program);
    std::ifstream maps("/proc/self/maps");
    // A line reads: BEGIN-END PERMISSIONS OFFSET DEVICE INODE PATH
    for (std::string line; std::getline(maps, line);) {
        std::uintptr_t begin = 0, end = 0;
        int path = 0;
        if (std::sscanf(line.c_str(), "%lx-%lx %*s %*s %*s %*s %n", &begin, &end, &path) == 2 &&
            begin <= here && here < end && path > 0)
            return line.substr(static_cast<std::size_t>(path));
    }
    throw ResourceError(
        "this program was not found in /proc/self/maps; check that /proc is mounted");
}

fs::path programs_folder() {
    const fs::path folder = running_program().parent_path();
    return folder.filename() == "programs" ? folder.parent_path() : folder;
}

fs::path launcher_program() {
    const fs::path folder = programs_folder();
    for (const fs::path& path : {folder / "item3d", folder / "../../bin/item3d"})
        if (std::error_code code; fs::exists(path, code)) return path.lexically_normal();
    throw ResourceError((folder / "item3d").string() +
                        ": does not exist; install item3d again, or run make in its sources");
}

}  // namespace item3d
