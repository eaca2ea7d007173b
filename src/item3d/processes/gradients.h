// Sum of the gradients of shared parameters over all processes.
#pragma once

#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Replaces each parameter's gradient by the sum over all processes. Sparse gradients ([rows, F]
/// float32, sparse in the rows) are summed in the order of ranks; the sum has all rows that any
/// process has, ascending. A gradient that no process has stays undefined. All processes get the
/// same bytes.
void sum_gradients(const ProcessGroup& processes, const std::vector<at::Tensor>& parameters);

}  // namespace item3d
