// Access to the CUDA kernels in libitem3d_cuda.so. This module is opened on first use, so that the
// program runs on machines without NVIDIA's libraries.
#pragma once

#include "item3d/render/cuda/table.h"
#include "item3d/tensors/tensor.h"

#include <c10/core/DeviceGuard.h>

#include <string>

namespace item3d::cuda {

/// True if LibTorch can compute on a CUDA device. The first call loads LibTorch's CUDA libraries if
/// a driver and libtorch_cuda.so exist. (scripts/setup.sh installs only the CPU libraries; another
/// LibTorch, given by ITEM3D_TORCH_ROOT, may have both.) LibTorch looks for CUDA only once, so call
/// this before torch::cuda::is_available().
bool cuda_available();

/// True if sums on devices must not depend on the order of threads. LibTorch's own switch,
/// at::globalContext().setDeterministicAlgorithms(), decides this.
bool deterministic_sums();

/// Returns the table that libitem3d_cuda.so exports under `symbol`. Opens the module, which lies
/// beside the program or in ../lib/item3d. Throws ResourceError with a message of one line when the
/// module is missing, cannot be opened, or comes from another build.
const TableHeader* find_table(const char* symbol, std::uint32_t size);

/// Returns the renderer's kernels. Throws the same errors as find_table().
const RenderTable& render_table();

/// Launches the kernel on the device's current stream. Throws ResourceError with CUDA's reason when
/// the launch fails. LibTorch reports later failures at its next synchronisation.
template <typename Parameters>
void run(Kernel<Parameters> kernel, const Parameters& parameters, std::int64_t count,
         at::Device device);

/// RAII guard that run() uses. It makes a device the current one for the guard's lifetime.
class Launch {
  public:
    explicit Launch(at::Device device);
    Stream stream() const { return stream_; }
    void check(int error) const;

  private:
    c10::OptionalDeviceGuard guard_;
    Stream stream_;
};

template <typename Parameters>
void run(Kernel<Parameters> kernel, const Parameters& parameters, std::int64_t count,
         at::Device device) {
    const Launch launch(device);
    launch.check(kernel(parameters, count, launch.stream()));
}

/// Returns sums, [elements] float32 on `device`. add(accumulator) launches kernels that accumulate
/// these sums. It is called once, or twice if the sums must not depend on the order of threads.
/// max_terms: largest number of terms of one sum.
template <typename Add>
at::Tensor sum_on_device(std::int64_t elements, std::int64_t max_terms, at::Device device,
                         const Add& add) {
    const auto options = at::TensorOptions().device(device);
    at::Tensor sums = at::zeros({elements}, options.dtype(at::kFloat));
    Accumulator accumulator;
    if (!deterministic_sums()) {
        accumulator.values = sums.data_ptr<float>();
        add(accumulator);
        return sums;
    }
    const at::Tensor largest = at::zeros({elements}, options.dtype(at::kInt));
    const at::Tensor fixed = at::zeros({elements}, options.dtype(at::kLong));
    accumulator.bits = accumulator_bits(max_terms);
    accumulator.largest = static_cast<std::uint32_t*>(largest.data_ptr());
    add(accumulator);
    accumulator.fixed = static_cast<unsigned long long*>(fixed.data_ptr());
    add(accumulator);
    run(render_table().finish_sums,
        FinishSumsParameters{accumulator.largest, accumulator.fixed, accumulator.bits,
                             sums.data_ptr<float>()},
        elements, device);
    return sums;
}

}  // namespace item3d::cuda
