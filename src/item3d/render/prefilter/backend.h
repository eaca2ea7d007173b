// Interface to the memory and the kernels of the processor that prefilters. It is a CPU or CUDA
// device of LibTorch (tensor_backend.h), or the CPU without LibTorch (host_backend.h).
#pragma once

#include "item3d/core/parallel.h"
#include "item3d/render/cuda/table.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace item3d {

/// Shared ownership of a processor's memory.
using Floats = std::shared_ptr<float[]>;

class PrefilterBackend {
  public:
    virtual ~PrefilterBackend() = default;

    /// True for a CUDA device, whose memory only its kernels and the functions below may access.
    virtual bool on_device() const = 0;
    /// Returns uninitialised memory.
    virtual Floats allocate(std::int64_t count) const = 0;
    /// Returns a copy of the CPU's `values`.
    virtual Floats upload(const std::vector<float>& values) const = 0;
    virtual void fill(float* values, std::int64_t count, float value) const = 0;
    virtual void copy(const float* from, std::int64_t count, float* to) const = 0;
    virtual void add(const float* terms, std::int64_t count, float* to) const = 0;

    /// Returns FarParameters::centres [S], then FarParameters::inverse_lengths [S, S].
    virtual Floats far_tables(int size) const = 0;
    /// Sums `rows` [count, columns] to `sums` [columns]. precise: true if the sums are computed in
    /// double precision.
    virtual void sum_rows(const float* rows, std::int64_t count, std::int64_t columns, bool precise,
                          float* sums) const = 0;
    /// Writes the indices of the `count` brightest texels, brightest first. Brightness is the sum
    /// of the three colours. The index is -1 for a texel whose brightness is at most `share` of the
    /// total brightness. colors: [texels, 3].
    virtual void brightest(const float* colors, std::int64_t texels, float share,
                           std::int64_t count, std::int64_t* indices) const = 0;

    /// Launches a kernel of the device's table. Throws ResourceError when the launch fails.
    using Launch = std::function<int(const cuda::RenderTable&, cuda::Stream)>;
    virtual void launch(const Launch& start) const = 0;
};

/// Runs a kernel over the indices in [0, count). The CPU calls kernel(parameters, i); a CUDA device
/// uses the entry of its table.
template <auto kernel, typename Parameters>
void run_kernel(const PrefilterBackend& backend, const char* name,
                cuda::Kernel<Parameters> cuda::RenderTable::*entry, const Parameters& parameters,
                std::int64_t count, std::int64_t grain = 256) {
    if (backend.on_device())
        backend.launch([&](const cuda::RenderTable& table, cuda::Stream stream) {
            return (table.*entry)(parameters, count, stream);
        });
    else
        parallel_for(
            name, count, [&](std::int64_t i) { kernel(parameters, i); }, grain);
}

}  // namespace item3d
