// The parallel loop of operations on tensors, which runs on LibTorch's threads.
#pragma once

#include <ATen/Parallel.h>

#include <cstdint>

#if defined(__SANITIZE_THREAD__)
#include <omp.h>

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>
#endif

namespace item3d {

/// Calls f(begin, end) for ranges that cover [0, count), in any order. Without need, no range has
/// fewer than `grain` indices. Unlike in parallel_for(), f can share a buffer among the indices of
/// a range, and may throw.
template <typename F>
void parallel_ranges(std::int64_t count, std::int64_t grain, const F& f) {
#if defined(__SANITIZE_THREAD__)
    // The thread sanitizer does not see the barriers of GCC's OpenMP library, see parallel_for().
    const std::int64_t ranges =
        std::min<std::int64_t>(at::get_num_threads(), count / std::max<std::int64_t>(grain, 1));
    if (ranges <= 1) {
        if (count > 0) f(0, count);
        return;
    }
    std::vector<std::exception_ptr> errors(static_cast<std::size_t>(ranges));
    std::vector<std::jthread> threads;
    for (std::int64_t range = 0; range < ranges; ++range)
        threads.emplace_back([&, range] {
            at::get_num_threads();  // sets the number of threads, which the next line changes
            omp_set_num_threads(1);
            try {
                f(count * range / ranges, count * (range + 1) / ranges);
            } catch (...) {
                errors[static_cast<std::size_t>(range)] = std::current_exception();
            }
        });
    threads.clear();  // waits for all
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
#else
    at::parallel_for(0, count, grain, f);
#endif
}

}  // namespace item3d
