// Tensors whose rows are distributed over processes.
#pragma once

#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <functional>

namespace item3d {

/// Gathers rows: each process passes its own rows, [n, ...] float32, which begin at row `first` of
/// [total, ...], and gets all rows. Differentiable: each process gets the gradient of its own rows,
/// summed over all processes. All processes must therefore call backward() through the result. If
/// all processes compute the same function of the rows, only one of them may pass a non-zero
/// gradient.
at::Tensor gather_rows(const ProcessGroup& processes, const at::Tensor& own, std::int64_t first,
                       std::int64_t total);

/// Returns a tensor [total, row...]. Each process computes its own range of it as rows(first,
/// count), which returns [count, row...] and is not called for an empty range. With several
/// processes the result has no gradient.
at::Tensor compute_rows(const ProcessGroup& processes, std::int64_t total, at::IntArrayRef row,
                        at::TensorOptions options,
                        const std::function<at::Tensor(std::int64_t, std::int64_t)>& rows);

}  // namespace item3d
