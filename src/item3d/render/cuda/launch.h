// The launch of a kernel function over indices, and the macros that expand a list of kernels
// (table.h). The file is only for .cu files, which nvcc compiles.
#pragma once

#include "item3d/render/cuda/table.h"

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__CUDA_ARCH__)
// NVTX calls them. glibc 2.34 gave them new versions, which older systems do not have.
__asm__(".symver dlopen,dlopen@GLIBC_2.2.5");
__asm__(".symver dlsym,dlsym@GLIBC_2.2.5");
__asm__(".symver dlclose,dlclose@GLIBC_2.2.5");
#endif

#include <cuda_runtime.h>
#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <cstdint>

namespace item3d::cuda {

template <typename F>
__global__ void for_each_index(std::int64_t count, F f) {
    const std::int64_t step = static_cast<std::int64_t>(gridDim.x) * blockDim.x;
    for (std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
         i < count; i += step)
        f(i);
}

/// Calls f(i) for every i in [0, count) on the device of `stream`, which must be the current
/// device. Returns a cudaError_t. name: name that profilers show (NVTX). The block size maximises
/// occupancy. If there are many more indices than threads on the device, each thread handles
/// several indices.
template <typename F>
int launch(const char* name, std::int64_t count, const F& f, Stream stream) {
    if (count <= 0) return cudaSuccess;
    constexpr std::int64_t waves = 32;
    int resident_blocks = 0, block_size = 0;
    const cudaError_t error =
        cudaOccupancyMaxPotentialBlockSize(&resident_blocks, &block_size, for_each_index<F>);
    if (error != cudaSuccess) return error;
    const std::int64_t blocks =
        std::min((count + block_size - 1) / block_size, waves * resident_blocks);
    nvtxRangePushA(name);
    for_each_index<<<static_cast<unsigned>(blocks), static_cast<unsigned>(block_size), 0,
                     static_cast<cudaStream_t>(stream)>>>(count, f);
    nvtxRangePop();
    return cudaGetLastError();
}

// Macros that expand a line of a list. The comment of each shows the expansion of the example in
// table.h.

/// int shade(const kernels::ShadeParameters& p, std::int64_t count, Stream stream);
#define ITEM3D_KERNEL_PROTOTYPE(entry, Parameters, ...) \
    int entry(const Parameters& p, std::int64_t count, Stream stream);

/// int shade(const kernels::ShadeParameters& p, std::int64_t count, Stream stream) {
///     return launch(
///         "shade", count, [=] __device__(std::int64_t i) { kernels::shade_forward(p, i); },
///         stream);
/// }
#define ITEM3D_KERNEL_DEFINITION(entry, Parameters, body, name)             \
    int entry(const Parameters& p, std::int64_t count, Stream stream) {     \
        return launch(                                                      \
            name, count, [=] __device__(std::int64_t i) { body; }, stream); \
    }

/// .shade = shade,
#define ITEM3D_KERNEL_INITIALIZER(entry, ...) .entry = entry,

}  // namespace item3d::cuda
