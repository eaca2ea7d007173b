#include "item3d/tensors/workers.h"

#include "item3d/core/progress.h"
#include "item3d/tensors/tensor.h"

#include <ATen/Parallel.h>
#include <malloc.h>
#include <omp.h>

#include <atomic>
#include <exception>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

namespace item3d {

void run_ranks(int threads, const std::function<void(int)>& body) {
    const int torch_threads = at::get_num_threads();
    std::exception_ptr first;
    std::mutex mutex;
    // No body begins before all threads were started, because bodies may wait for each other.
    std::promise<bool> started;
    const std::shared_future<bool> complete = started.get_future().share();
    std::vector<std::jthread> running;
    const auto run = [&](int rank) {
        if (!complete.get()) return;
        try {
            at::set_num_threads(1);
            omp_set_num_threads(1);
            body(rank);
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!first) first = std::current_exception();
        }
    };
    try {
        for (int rank = 0; rank < threads; ++rank)
            running.emplace_back(run, rank);
    } catch (...) {
        started.set_value(false);
        throw;
    }
    started.set_value(true);
    running.clear();  // waits for all
    at::set_num_threads(torch_threads);
    if (first) std::rethrow_exception(first);
}

void run_workers(std::int64_t count, int threads, const std::function<void(std::int64_t)>& work) {
    std::atomic<std::int64_t> next = 0;
    run_ranks(threads, [&](int) {
        at::NoGradGuard no_grad;
        try {
            for (std::int64_t i = next++; i < count && !interrupted(); i = next++)
                work(i);
        } catch (...) {
            next = count;
            throw;
        }
    });
}

void keep_freed_memory() {
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_TOP_PAD, 64 << 20);
}

}  // namespace item3d
