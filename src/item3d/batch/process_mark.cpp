#include "item3d/batch/process_mark.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string first_line_of(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

/// Returns a process's start time in ticks since boot. Returns "" if there is no such process, or
/// if it is a zombie.
std::string start_of(long pid) {
    const std::string line = first_line_of("/proc/" + std::to_string(pid) + "/stat");
    // The program's name, in parentheses, may contain spaces and parentheses.
    const std::size_t behind = line.rfind(')');
    if (behind == std::string::npos) return "";
    std::istringstream fields(line.substr(behind + 1));
    std::string field;
    constexpr int state = 1, start = 20;  // fields 3 and 22 of the whole line
    for (int i = 1; fields >> field; ++i) {
        if (i == state && (field == "Z" || field == "X")) return "";
        if (i == start) return field;
    }
    return "";
}

std::string space_of_ids() {
    std::error_code code;
    return first_line_of("/proc/sys/kernel/random/boot_id") + " " +
           fs::read_symlink("/proc/self/ns/pid", code).string();
}

}  // namespace

std::string host_name() {
    char name[256] = {};
    ::gethostname(name, sizeof(name) - 1);
    const std::string whole = name;
    return whole.substr(0, whole.find('.'));
}

nlohmann::json this_process() {
    const long pid = ::getpid();
    return {
        {"host", host_name()}, {"pid", pid}, {"start", start_of(pid)}, {"space", space_of_ids()}};
}

bool has_ended(const nlohmann::json& process) {
    const auto text = [&](const char* key) {
        const auto found = process.find(key);
        return found != process.end() && found->is_string() ? found->get<std::string>() : "";
    };
    if (!process.is_object() || text("space") != space_of_ids()) return false;
    const auto pid = process.find("pid");
    return pid != process.end() && pid->is_number_integer() &&
           start_of(pid->get<long>()) != text("start");
}

}  // namespace item3d
