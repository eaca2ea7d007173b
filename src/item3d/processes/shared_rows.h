// Rows of a tensor of which each process computes some.
#pragma once

#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <functional>

namespace item3d {

/// [n, ...] float32 of each process, its own rows of [total, ...] beginning with `first` -> all of
/// them, on every process. Differentiable: each process gets the sum of all processes' gradients of
/// its rows, so all must call backward() through it; where the same is computed of the rows on all
/// of them, one alone must do so with a gradient that is not zero.
at::Tensor gather_rows(const ProcessGroup& processes, const at::Tensor& own, std::int64_t first,
                       std::int64_t total);

/// [total, row...] of which each process computes its share by rows(first, count) -> [count,
/// row...]; a process without any does not call it. A constant with several processes.
at::Tensor compute_rows(const ProcessGroup& processes, std::int64_t total, at::IntArrayRef row,
                        at::TensorOptions options,
                        const std::function<at::Tensor(std::int64_t, std::int64_t)>& rows);

}  // namespace item3d
