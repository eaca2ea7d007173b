// Training on several processes or machines: what they add up and hand on, over LibTorch's c10d
// with Gloo, started by torchrun or by hand.
#pragma once

#include "item3d/core/error.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <chrono>
#include <memory>
#include <string>

namespace item3d {

/// A connection broke because another process ended or cannot be reached any more.
class LostProcess : public ResourceError {
  public:
    explicit LostProcess(const std::string& reason);
};

/// One process's place among those that train together. All of them call the same functions in the
/// same order, from one thread at a time. Copies share the connection. Every function throws
/// LostProcess, or Interrupted where this process was interrupted, when another one is gone.
class ProcessGroup {
  public:
    /// A single process: nothing is sent, every function returns at once.
    ProcessGroup() = default;
    /// As RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT say, which torchrun sets; a single process
    /// where they are not set or WORLD_SIZE is 1. Waits until all have come. Throws InputError for
    /// values that cannot be, or when not all have come after `patience`.
    static ProcessGroup from_environment(std::chrono::seconds patience = std::chrono::minutes(10));

    int rank() const { return rank_; }  ///< 0 .. size() - 1
    int size() const { return size_; }
    /// Of process 0, which makes the data and writes all files.
    bool first() const { return rank_ == 0; }

    /// Adds up float32 tensors of one size in place. All processes get the same bytes; two of them
    /// the same as a + b. The tensor is contiguous and on the CPU.
    void sum(at::Tensor tensor) const;
    /// Process 0's; what others give is not looked at.
    std::string broadcast(const std::string& text) const;
    NamedTensors broadcast(const NamedTensors& tensors) const;
    /// Waits for all, for half an hour at most.
    void barrier() const;
    /// Others wait here for process 0, which may take hours over the data.
    void wait_for_first() const;

  private:
    struct Connection;

    int rank_ = 0;
    int size_ = 1;
    std::shared_ptr<Connection> connection_;
};

}  // namespace item3d
