// Worker threads, each with one LibTorch thread inside: for many small tasks this is faster than
// the parallelism inside operations.
#pragma once

#include <cstdint>
#include <functional>

namespace item3d {

/// Calls work(i) for i in [0, count) on `threads` threads, in any order, without gradients. The
/// first exception stops the others and is rethrown here. Also stops, without exception, between
/// two tasks after an interrupt: the caller must check interrupted().
void run_workers(std::int64_t count, int threads, const std::function<void(std::int64_t)>& work);

/// Calls body(rank) once on each of `threads` threads with one LibTorch thread inside, and blocks
/// until all have ended. Then rethrows the first exception. A body that waits for the other threads
/// must itself ensure that they end.
void run_ranks(int threads, const std::function<void(int)>& body);

/// Makes the heap keep freed memory for the next training step. By default, the memory of each
/// large tensor is mapped, cleared by the kernel and unmapped again, which takes a tenth of a
/// step's time.
void keep_freed_memory();

}  // namespace item3d
