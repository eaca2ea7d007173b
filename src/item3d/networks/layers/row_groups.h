// Parallelism over groups of a batch's elements, with one thread for each group. The operations of
// a small network are too short to be parallelised one by one.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>

namespace item3d {

/// Computes the batch elements [first, first + count): f(first, count, their text) -> [count, ...].
using RowFunction =
    std::function<at::Tensor(std::int64_t first, std::int64_t count, const at::Tensor& text)>;

/// Returns f of all batch elements of text [N, ...] as [N, ...]. Differentiable in text alone.
/// Groups, and so results, depend on N and not on the number of threads. f is called from several
/// threads.
at::Tensor in_row_groups(const at::Tensor& text, const RowFunction& f);

}  // namespace item3d
