#include "item3d/core/available_memory.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr double unlimited = 1e18;

double of_the_machine() {
    std::ifstream file("/proc/meminfo");
    std::string key, unit;
    double kilobytes = 0;
    while (file >> key >> kilobytes && std::getline(file, unit))
        if (key == "MemAvailable:") return 1024 * kilobytes;
    return unlimited;
}

/// Returns the number in a file, or `otherwise` if the file has no number but a word ("max").
double number_in(const fs::path& path, double otherwise) {
    std::ifstream file(path);
    double value = 0;
    return file >> value ? value : otherwise;
}

/// Returns the size of the cached files, which count towards the group's limit although the system
/// can free them.
double reclaimable(const fs::path& group) {
    std::ifstream file(group / "memory.stat");
    std::string key;
    double value = 0;
    while (file >> key >> value)
        if (key == "inactive_file") return value;
    return 0;
}

/// Returns the free memory of this process's control group and its ancestors (cgroups version 2).
double of_the_groups() {
    std::ifstream file("/proc/self/cgroup");
    std::string line, group;
    while (std::getline(file, line))
        if (line.starts_with("0::/")) group = line.substr(4);
    const fs::path root = "/sys/fs/cgroup";
    double left = unlimited;
    for (fs::path folder = root / group; folder != root && folder.has_relative_path();
         folder = folder.parent_path()) {
        const double limit = number_in(folder / "memory.max", unlimited);
        if (limit < unlimited)
            left = std::min(left,
                            limit - number_in(folder / "memory.current", 0) + reclaimable(folder));
    }
    return std::max(0.0, left);
}

}  // namespace

double available_memory() {
    return std::min(of_the_machine(), of_the_groups());
}

}  // namespace item3d
