// Group of processes that train or edit together, on one machine or several. torchrun or the user
// starts them. They exchange sums and broadcasts over LibTorch's c10d with Gloo.
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

/// Returns the range of `total` rows for process `rank` of `size`. The sizes of ranges differ by
/// one row at most. Ranges are consecutive in the order of ranks.
Share share_of(int rank, int size, std::int64_t total);

/// Group of processes as seen by one of them. All processes must call the same functions in the
/// same order, each from one thread at a time. Copies share the connection. Every function throws
/// LostProcess if another process is gone, or Interrupted if this process was also interrupted.
class ProcessGroup {
  public:
    /// Makes a group of a single process. Nothing is sent, and every function returns at once.
    ProcessGroup() = default;
    /// Joins the group given by RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT, which torchrun sets.
    /// Returns a group of a single process if they are unset or WORLD_SIZE is 1. Blocks until all
    /// have joined. Throws InputError for invalid values, or if not all have joined after
    /// `timeout`.
    static ProcessGroup from_environment(std::chrono::seconds timeout = std::chrono::minutes(10));

    int rank() const { return rank_; }  ///< 0 .. size() - 1
    int size() const { return size_; }
    bool several() const { return size_ > 1; }
    /// True in process 0, which writes all files.
    bool first() const { return rank_ == 0; }
    /// Returns this process's range of `total` rows, as share_of() does.
    Share share(std::int64_t total) const { return share_of(rank_, size_, total); }

    /// Replaces the processes' tensors, which are contiguous float32 of one size, by their sum. All
    /// processes get the same bytes; for two processes with tensors a and b, the result is exactly
    /// a + b. GPU tensors are copied through the CPU's memory.
    void sum(at::Tensor tensor) const;
    /// Returns the tensors of all processes, on the CPU, in the order of ranks. They must have one
    /// size and type.
    std::vector<at::Tensor> gather(const at::Tensor& tensor) const;
    /// Returns true if any process passes true.
    bool any(bool said) const;
    /// Returns the argument of process 0. The arguments of the other processes are ignored.
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
