// A CUDA device in the tests: it replaces python/src/device.cpp. All tensors are taken for tensors
// on a device, and the kernels of the device's table run on the CPU, from the last index to the
// first. So the operators' code for devices runs without a GPU, except for the launches themselves.
#include "python/src/device.h"

namespace item3d::cuda {
namespace {

#define ITEM3D_EMULATED_KERNEL(entry, Parameters, body, name)    \
    int entry(const Parameters& p, std::int64_t count, Stream) { \
        for (std::int64_t i = count; i-- > 0;) {                 \
            body;                                                \
        }                                                        \
        return 0;                                                \
    }
#define ITEM3D_EMULATED_ENTRY(entry, ...) .entry = entry,

ITEM3D_RENDER_KERNELS(ITEM3D_EMULATED_KERNEL)

const char* error_text(int) {
    return "no error";
}

constexpr RenderTable table{.header = {table_version, sizeof(RenderTable)},
                            .error_text = error_text,
                            ITEM3D_RENDER_KERNELS(ITEM3D_EMULATED_ENTRY)};

}  // namespace
}  // namespace item3d::cuda

namespace item3d::python {

bool on_device(const torch::stable::Tensor&) {
    return true;
}

const cuda::RenderTable& device_kernels() {
    return cuda::table;
}

struct DeviceGuard::Current {};

DeviceGuard::DeviceGuard(std::int32_t) {}

DeviceGuard::~DeviceGuard() = default;

}  // namespace item3d::python
