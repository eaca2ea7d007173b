// Boundary checks of the renderer's operations.
#pragma once

#include <torch/types.h>

#include <initializer_list>

namespace item3d {

/// Returns `tensor`, made contiguous. Throws std::logic_error naming the wanted and the found
/// device, type and shape unless it is a CPU tensor of `type` and `shape`, where -1 stands for any
/// size.
torch::Tensor checked(const char* operation, const char* name, const torch::Tensor& tensor,
                      torch::ScalarType type, std::initializer_list<std::int64_t> shape);

}  // namespace item3d
