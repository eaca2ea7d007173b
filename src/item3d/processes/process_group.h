// Processes that train or edit together, on one machine or several: what they add up and hand on,
// over LibTorch's c10d with Gloo, started by torchrun or by hand.
#pragma once

#include "item3d/core/error.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A connection broke because another process ended or cannot be reached any more.
class LostProcess : public ResourceError {
  public:
    explicit LostProcess(const std::string& reason);
};

/// A process's part of some rows: [first, first + count).
struct Share {
    std::int64_t first = 0;
    std::int64_t count = 0;
    std::int64_t end() const { return first + count; }
};

/// The part of `total` rows of one of `size` processes: parts differ by one row at most, and follow
/// one another in the order of ranks.
Share share_of(int rank, int size, std::int64_t total);

/// One process's place among those that work together. All of them call the same functions in the
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
    bool several() const { return size_ > 1; }
    /// Of process 0, which writes all files.
    bool first() const { return rank_ == 0; }
    /// This process's part of `total` rows, share_of().
    Share share(std::int64_t total) const { return share_of(rank_, size_, total); }

    /// Adds up contiguous float32 tensors of one size in place. All processes get the same bytes;
    /// two of them the same as a + b. Those of a device go through the CPU's memory.
    void sum(at::Tensor tensor) const;
    /// Tensors of one size and type, by rank, on the CPU.
    std::vector<at::Tensor> gather(const at::Tensor& tensor) const;
    /// Whether any process says so.
    bool any(bool said) const;
    /// Process 0's; what others give is not looked at.
    std::string broadcast(const std::string& text) const;
    NamedTensors broadcast(const NamedTensors& tensors) const;
    /// Waits for all, for half an hour at most.
    void barrier() const;
    /// Others wait here for process 0, which may take hours.
    void wait_for_first() const;

    /// Seconds in which this process sent, received, and waited for others to do so; without
    /// wait_for_first().
    double exchange_seconds() const;

  private:
    struct Connection;

    int rank_ = 0;
    int size_ = 1;
    std::shared_ptr<Connection> connection_;
};

}  // namespace item3d
