#include "item3d/processes/local_device.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <vector>

namespace item3d {
namespace {

std::string text_of(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? value : "";
}

/// Counts the folders that the NVIDIA driver has, one for each device.
int count_of_devices() {
    std::error_code error;
    const std::filesystem::directory_iterator devices("/proc/driver/nvidia/gpus", error);
    return error ? 0 : static_cast<int>(std::distance(begin(devices), end(devices)));
}

}  // namespace

std::string own_device(int local_rank, const std::string& visible, int count) {
    std::vector<std::string> devices;
    for (std::size_t first = 0; first < visible.size();) {
        const std::size_t comma = std::min(visible.find(',', first), visible.size());
        devices.push_back(visible.substr(first, comma - first));
        first = comma + 1;
    }
    if (visible.empty())
        for (int device = 0; device < count; ++device)
            devices.push_back(std::to_string(device));
    if (devices.empty() || local_rank < 0) return "";
    return devices[static_cast<std::size_t>(local_rank) % devices.size()];
}

void take_own_device() {
    const std::string rank = text_of("LOCAL_RANK"), size = text_of("WORLD_SIZE");
    if (rank.empty() || size.empty() || size == "1") return;
    const std::string device =
        own_device(std::atoi(rank.c_str()), text_of("CUDA_VISIBLE_DEVICES"), count_of_devices());
    if (!device.empty()) ::setenv("CUDA_VISIBLE_DEVICES", device.c_str(), 1);
}

}  // namespace item3d
