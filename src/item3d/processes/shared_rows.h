// Tensors whose rows are distributed over processes.
#pragma once

#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <functional>

namespace item3d {

/// Gathers rows: [n, ...] float32 of each process, its rows of [total, ...] from `first` on, become
/// all rows on every process. Differentiable: each process gets the sum of all processes' gradients
/// of its rows, so all must call backward() through it; if all compute the same function of the
/// rows, only one may do so with a non-zero gradient.
at::Tensor gather_rows(const ProcessGroup& processes, const at::Tensor& own, std::int64_t first,
                       std::int64_t total);

/// Returns [total, row...], of which each process computes its range by rows(first, count) ->
/// [count, row...]; a process without rows does not call it. With several processes the result has
/// no gradient.
at::Tensor compute_rows(const ProcessGroup& processes, std::int64_t total, at::IntArrayRef row,
                        at::TensorOptions options,
                        const std::function<at::Tensor(std::int64_t, std::int64_t)>& rows);

}  // namespace item3d
