// Memory for a network's weights, separate from temporary tensors.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstddef>
#include <memory>

namespace item3d {

/// Memory pages for weights alone. They are large pages if available. They return to the system
/// when their last tensor is freed. Weights on the heap would leave holes between activations.
class WeightMemory {
  public:
    /// Reserves memory for this many bytes of CPU weights. Each tensor is 64-byte aligned and takes
    /// room_for() bytes. Throws ResourceError if the system has no memory left.
    explicit WeightMemory(std::size_t bytes);

    /// Returns the bytes that a tensor takes.
    static std::size_t room_for(at::IntArrayRef sizes, at::ScalarType dtype);

    /// Returns a contiguous tensor of zeros in the next part of the memory.
    at::Tensor empty(at::IntArrayRef sizes, at::ScalarType dtype);

  private:
    struct Pages;
    std::shared_ptr<Pages> pages_;
    std::size_t used_ = 0;
};

/// Returns one tensor in a WeightMemory of its own, or on the heap if it is small.
at::Tensor empty_weight(at::IntArrayRef sizes, at::ScalarType dtype);

}  // namespace item3d
