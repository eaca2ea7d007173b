// Memory for a network's weights, apart from what comes and goes while it runs.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstddef>
#include <memory>

namespace item3d {

/// Pages of their own for weights, large ones if the system has them. They go back to the system
/// with the last tensor in them, whereas weights on the heap leave holes between activations.
class WeightMemory {
  public:
    /// Room for so many bytes of weights of the CPU, 64-byte aligned each: see room_for(). Throws
    /// ResourceError where the system has none.
    explicit WeightMemory(std::size_t bytes);

    /// What a tensor takes of it.
    static std::size_t room_for(at::IntArrayRef sizes, at::ScalarType dtype);

    /// Numbers not yet written (zero), contiguous, in the next part of the memory.
    at::Tensor empty(at::IntArrayRef sizes, at::ScalarType dtype);

  private:
    struct Pages;
    std::shared_ptr<Pages> pages_;
    std::size_t used_ = 0;
};

/// One tensor in such memory, or on the heap where it is small.
at::Tensor empty_weight(at::IntArrayRef sizes, at::ScalarType dtype);

}  // namespace item3d
