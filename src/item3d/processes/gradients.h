// Gradients of parameters that all processes hold, added up.
#pragma once

#include "item3d/processes/process_group.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Makes each parameter's gradient the sum of all processes' gradients of it, in the order of ranks
/// where it is sparse ([rows, F] float32 of one index): the rows are those that any of them has, in
/// rising order. One that no process has stays undefined. All processes get the same bytes.
void sum_gradients(const ProcessGroup& processes, const std::vector<at::Tensor>& parameters);

}  // namespace item3d
