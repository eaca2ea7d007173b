#include "item3d/networks/diffusion/adapter_file.h"

#include "item3d/core/error.h"

#include <array>
#include <fstream>

namespace item3d {
namespace {

bool is_pickle(const std::filesystem::path& file) {
    for (const char* extension : {".pt", ".pth", ".bin", ".ckpt", ".pkl"})
        if (file.extension() == extension) return true;
    // PyTorch files begin like a zip archive ("PK") or with the first opcode of a pickle.
    std::array<char, 2> start{};
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(start.data(), start.size())) return false;
    return (start[0] == 'P' && start[1] == 'K') ||
           (start[0] == '\x80' && start[1] >= 2 && start[1] <= 5);
}

/// True for the beginning of a safetensors file: eight bytes of length, then a JSON object.
bool has_json_header(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(8);
    return stream.get() == '{';
}

}  // namespace

AdapterArgument split_adapter_argument(const std::string& argument) {
    const std::size_t colon = argument.rfind(':');
    std::error_code too_long;
    if (colon == std::string::npos || std::filesystem::exists(argument, too_long))
        return {argument, ""};
    return {argument.substr(0, colon), argument.substr(colon + 1)};
}

SafeTensors open_adapter(const std::filesystem::path& file) {
    std::error_code too_long;
    if (std::filesystem::is_regular_file(file, too_long) && is_pickle(file) &&
        !has_json_header(file))
        throw InputError(file.string(),
                         "is a pickle, which can run code when it is loaded; expected .safetensors",
                         "use a .safetensors version, or convert it if you trust its author");
    return SafeTensors::open(file);
}

}  // namespace item3d
