// Dispatch of a kernel to the CPU's threads or to a CUDA device.
#pragma once

#include "item3d/core/parallel.h"
#include "item3d/render/cuda/module.h"

namespace item3d {

/// Runs a kernel over the indices in [0, count). The CPU calls kernel(parameters, i); a CUDA device
/// uses the entry of its table. Throws the same errors as cuda::run().
template <auto kernel, typename Parameters>
void dispatch(at::Device device, const char* name,
              cuda::Kernel<Parameters> cuda::RenderTable::*entry, const Parameters& parameters,
              std::int64_t count, std::int64_t grain = 256) {
    if (device.is_cuda())
        cuda::run(cuda::render_table().*entry, parameters, count, device);
    else
        parallel_for(
            name, count, [&](std::int64_t i) { kernel(parameters, i); }, grain);
}

}  // namespace item3d
