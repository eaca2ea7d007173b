// Argument checks of the renderer's operations.
#pragma once

#include "item3d/tensors/tensor.h"

#include <initializer_list>

namespace item3d {

/// Returns `tensor`, made contiguous. Throws std::logic_error unless the tensor is on `device`, of
/// `type` and of `shape`, where -1 matches any size. The message has the expected and the actual
/// device, type and shape.
at::Tensor checked(const char* operation, const char* name, const at::Tensor& tensor,
                   at::ScalarType type, std::initializer_list<std::int64_t> shape,
                   at::Device device = at::kCPU);

/// Returns the device of an operation's first input, the CPU or a CUDA device. All other inputs
/// must be on this device too. Throws std::logic_error for an undefined tensor or another kind of
/// device.
at::Device operation_device(const char* operation, const at::Tensor& tensor);

}  // namespace item3d
