// Boundary checks of the renderer's operations.
#pragma once

#include "item3d/tensors/tensor.h"

#include <initializer_list>

namespace item3d {

/// Returns `tensor`, made contiguous. Throws std::logic_error naming the wanted and the found
/// device, type and shape unless it is on `device`, of `type` and of `shape`, where -1 stands for
/// any size.
at::Tensor checked(const char* operation, const char* name, const at::Tensor& tensor,
                   at::ScalarType type, std::initializer_list<std::int64_t> shape,
                   at::Device device = at::kCPU);

/// The device of an operation's first input, which the others must be on as well: the CPU or a CUDA
/// device. Throws std::logic_error for an undefined tensor or another kind of device.
at::Device operation_device(const char* operation, const at::Tensor& tensor);

}  // namespace item3d
