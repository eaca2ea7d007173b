// Group of processes that train or edit together, on one machine or several: sums and broadcasts
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

/// Thrown if a connection broke because another process ended or is unreachable.
class LostProcess : public ResourceError {
  public:
    explicit LostProcess(const std::string& reason);
};

/// Range of a tensor's rows that belongs to one process: [first, first + count).
struct Share {
    std::int64_t first = 0;
    std::int64_t count = 0;
    std::int64_t end() const { return first + count; }
};

/// Returns the range of `total` rows for one of `size` processes: ranges differ by one row at most,
/// and are consecutive in the order of ranks.
Share share_of(int rank, int size, std::int64_t total);

/// Group of processes as seen by one of them. All call the same functions in the same order, from
/// one thread at a time. Copies share the connection. Every function throws LostProcess if another
/// process is gone, or Interrupted if this process was also interrupted.
class ProcessGroup {
  public:
    /// Group of a single process: nothing is sent, every function returns at once.
    ProcessGroup() = default;
    /// Joins the group given by RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT, which torchrun sets;
    /// a single process if they are unset or WORLD_SIZE is 1. Blocks until all have joined. Throws
    /// InputError for invalid values, or if not all have joined after `timeout`.
    static ProcessGroup from_environment(std::chrono::seconds timeout = std::chrono::minutes(10));

    int rank() const { return rank_; }  ///< 0 .. size() - 1
    int size() const { return size_; }
    bool several() const { return size_ > 1; }
    /// True in process 0, which writes all files.
    bool first() const { return rank_ == 0; }
    /// Returns this process's range of `total` rows, share_of().
    Share share(std::int64_t total) const { return share_of(rank_, size_, total); }

    /// Sums contiguous float32 tensors of one size in place. All processes get the same bytes; for
    /// two processes these are exactly a + b. GPU tensors are copied through the CPU's memory.
    void sum(at::Tensor tensor) const;
    /// Returns the processes' tensors, of one size and type, by rank, on the CPU.
    std::vector<at::Tensor> gather(const at::Tensor& tensor) const;
    /// Returns true if any process passes true.
    bool any(bool said) const;
    /// Returns process 0's text; the others' argument is ignored.
    std::string broadcast(const std::string& text) const;
    NamedTensors broadcast(const NamedTensors& tensors) const;
    /// Blocks until all processes arrive, for half an hour at most.
    void barrier() const;
    /// Blocks until process 0 arrives, which may take hours.
    void wait_for_first() const;

    /// Seconds that this process spent sending, receiving, and waiting for others to send or
    /// receive. The time in wait_for_first() is not included.
    double exchange_seconds() const;

  private:
    struct Connection;

    int rank_ = 0;
    int size_ = 1;
    std::shared_ptr<Connection> connection_;
};

}  // namespace item3d
