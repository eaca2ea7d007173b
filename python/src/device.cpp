#include "python/src/device.h"

#include <dlfcn.h>
#include <torch/csrc/inductor/aoti_torch/c/shim.h>
#include <torch/csrc/stable/accelerator.h>

#include <stdexcept>
#include <string>

namespace item3d::python {
namespace {

constexpr const char* file_name = "libitem3d_cuda.so";

[[noreturn]] void cannot_use(const std::string& reason) {
    throw std::runtime_error("item3d cannot compute on CUDA: " + reason +
                             "; move the tensors to the CPU (tensor.cpu())");
}

/// Returns the folder of this library.
std::string own_folder() {
    Dl_info info{};
    if (dladdr(reinterpret_cast<const void*>(&file_name), &info) == 0) return ".";
    const std::string path = info.dli_fname;
    return path.substr(0, path.find_last_of('/'));
}

const cuda::RenderTable& open_kernels() {
    const std::string path = own_folder() + "/" + file_name;
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        const char* problem = dlerror();
        cannot_use(std::string(problem ? problem : path + " cannot be opened") +
                   " (docs/python.md describes how to install the kernels for CUDA)");
    }
    // POSIX guarantees that the pointer returned by dlsym can hold a function pointer.
    const auto function =
        reinterpret_cast<cuda::RenderTableFunction*>(dlsym(library, "item3d_cuda_render"));
    if (function == nullptr) cannot_use(path + " has no item3d_cuda_render");
    const cuda::RenderTable* table = function();
    if (table->header.version != cuda::table_version ||
        table->header.size != sizeof(cuda::RenderTable))
        cannot_use(path + " belongs to another version of item3d");
    return *table;
}

/// Returns LibTorch's function for the current stream, or null. The function is in
/// libtorch_cuda.so, which this library does not link. If there are tensors on a device, PyTorch
/// has loaded it.
auto find_stream_function() {
    using Function = AOTITorchError(std::int32_t, void**);
    void* library = dlopen("libtorch_cuda.so", RTLD_NOW | RTLD_NOLOAD);
    return library == nullptr
               ? nullptr
               : reinterpret_cast<Function*>(dlsym(library, "aoti_torch_get_current_cuda_stream"));
}

cuda::Stream current_stream(std::int32_t device) {
    static auto* const function = find_stream_function();
    void* stream = nullptr;
    if (function == nullptr || function(device, &stream) != 0)
        cannot_use("PyTorch does not tell its current stream");
    return stream;
}

}  // namespace

bool on_device(const torch::stable::Tensor& tensor) {
    return tensor.is_cuda();
}

const cuda::RenderTable& device_kernels() {
    static const cuda::RenderTable& kernels = open_kernels();
    return kernels;
}

struct DeviceGuard::Current {
    torch::stable::accelerator::DeviceGuard guard;
};

DeviceGuard::DeviceGuard(std::int32_t device)
    : current_(std::make_unique<Current>(Current{torch::stable::accelerator::DeviceGuard(device)})),
      stream_(current_stream(device)) {}

DeviceGuard::~DeviceGuard() = default;

}  // namespace item3d::python
