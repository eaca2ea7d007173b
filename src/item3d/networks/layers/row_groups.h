// Rows of a batch a few at a time, each few on a thread of its own: a small network's operations
// are too short to be shared out among threads one by one.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <functional>

namespace item3d {

/// f(first, count, text rows) -> [count, ...] for rows [first, first + count) of a batch.
using RowFunction =
    std::function<at::Tensor(std::int64_t first, std::int64_t count, const at::Tensor& text)>;

/// f for all rows of text [N, ...] -> [N, ...]. Differentiable in text alone. The groups depend on
/// N and not on the number of threads, and so do not the results. f is called from several threads.
at::Tensor in_row_groups(const at::Tensor& text, const RowFunction& f);

}  // namespace item3d
