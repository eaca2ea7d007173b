// Worker threads, in each of which LibTorch uses one thread. For many small tasks this is faster
// than the parallelism inside operations.
#pragma once

#include <cstdint>
#include <functional>

namespace item3d {

/// Calls work(i) for i in [0, count) on `threads` threads, in any order, without gradients. The
/// first exception stops the other threads and is rethrown here. After an interrupt, the threads
/// stop between two tasks without an exception, so the caller must check interrupted().
void run_workers(std::int64_t count, int threads, const std::function<void(std::int64_t)>& work);

/// Calls body(rank) once on each of `threads` threads, in each of which LibTorch uses one thread.
/// Blocks until all have ended. Then rethrows the first exception. A body that waits for the other
/// threads must itself ensure that they end. Throws std::system_error, without calling body, if a
/// thread cannot be started.
void run_ranks(int threads, const std::function<void(int)>& body);

/// Makes the heap keep freed memory for the next training step. By default, the memory of each
/// large tensor is mapped, cleared by the kernel and unmapped again, which takes a tenth of a
/// step's time.
void keep_freed_memory();

}  // namespace item3d
