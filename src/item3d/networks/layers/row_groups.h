// Parallelism over groups of a batch's rows, one thread each: a small network's operations are too
// short to be parallelised one by one.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>

namespace item3d {

/// Computes rows [first, first + count) of a batch: f(first, count, text rows) -> [count, ...].
using RowFunction =
    std::function<at::Tensor(std::int64_t first, std::int64_t count, const at::Tensor& text)>;

/// Returns f of all rows of text [N, ...], [N, ...]. Differentiable in text alone. Groups, and so
/// results, depend on N and not on the number of threads. f is called from several threads.
at::Tensor in_row_groups(const at::Tensor& text, const RowFunction& f);

}  // namespace item3d
