// Access to CUDA devices: the tensors in their memory, and the kernels of libitem3d_cuda.so, which
// lies beside this library. The tests of the operators for devices replace device.cpp by functions
// that run the same kernels on the CPU (python/tests/emulated_device.cpp).
#pragma once

#include "item3d/render/cuda/table.h"

#include <torch/csrc/stable/tensor.h>

#include <memory>

#if defined(__x86_64__) && defined(__GLIBC__)
// LibTorch's headers call dlsym, and device.cpp all four. glibc 2.34 gave them new versions, which
// older systems do not have.
__asm__(".symver dlsym,dlsym@GLIBC_2.2.5");
__asm__(".symver dlopen,dlopen@GLIBC_2.2.5");
__asm__(".symver dlerror,dlerror@GLIBC_2.2.5");
__asm__(".symver dladdr,dladdr@GLIBC_2.2.5");
#endif

namespace item3d::python {

/// True if only kernels reach the tensor's memory.
bool on_device(const torch::stable::Tensor& tensor);

/// Returns the kernels for devices. The first call opens libitem3d_cuda.so. Throws
/// std::runtime_error with a message of one line if it is missing, or belongs to another version.
const cuda::RenderTable& device_kernels();

/// RAII guard that makes a device the current one, and finds PyTorch's current stream on it.
class DeviceGuard {
  public:
    explicit DeviceGuard(std::int32_t device);
    ~DeviceGuard();
    DeviceGuard(const DeviceGuard&) = delete;
    DeviceGuard& operator=(const DeviceGuard&) = delete;

    cuda::Stream stream() const { return stream_; }

  private:
    struct Current;  ///< makes a device the current one
    std::unique_ptr<Current> current_;
    cuda::Stream stream_ = nullptr;
};

}  // namespace item3d::python
