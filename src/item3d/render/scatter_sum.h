// Scatter-adds whose result does not depend on the number of threads.
#pragma once

#include "item3d/core/parallel.h"
#include "item3d/tensors/tensor.h"

#include <algorithm>

namespace item3d {

/// Returns the sums of the values that add(i, buffer) adds to a buffer of `elements` floats, over i
/// in [0, count). Splits the work into eight chunks, each with its own buffer, and sums the buffers
/// in order. The buffers take 8 * elements floats.
template <typename F>
at::Tensor scatter_sum(const char* name, std::int64_t count, std::int64_t elements, const F& add) {
    constexpr std::int64_t chunks = 8;
    at::Tensor buffers = at::zeros({chunks, elements}, at::kFloat);
    float* data = buffers.data_ptr<float>();
    parallel_for(
        name, chunks,
        [=, &add](std::int64_t chunk) {
            for (std::int64_t i = count * chunk / chunks; i < count * (chunk + 1) / chunks; ++i)
                add(i, data + chunk * elements);
        },
        count < 4096 ? chunks : 1);
    return buffers.sum(0);
}

}  // namespace item3d
