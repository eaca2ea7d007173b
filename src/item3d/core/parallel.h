// The parallel loop of per-pixel and per-texel kernels on the CPU's threads.
#pragma once

#if !defined(ITEM3D_OTHER_THREADS)
#include <omp.h>
#endif

#include <algorithm>
#include <cstdint>
#include <exception>
#include <thread>
#include <vector>

namespace item3d {

#if defined(ITEM3D_OTHER_THREADS)

/// Returns the number of threads of the calling program. For the Python package, these are
/// PyTorch's threads.
int thread_count();
/// Calls run(f, block) for every block in [0, blocks), in any order, on the threads of the calling
/// program.
void run_on_threads(std::int64_t blocks, const void* f,
                    void (*run)(const void* f, std::int64_t block));

template <typename F>
void parallel_for(const char*, std::int64_t count, const F& f, std::int64_t grain = 256) {
    const std::int64_t blocks = (count + grain - 1) / grain;
    const auto run = [&f, count, grain](std::int64_t block) {
        const std::int64_t end = std::min(count, (block + 1) * grain);
        for (std::int64_t i = block * grain; i < end; ++i)
            f(i);
    };
    if (blocks <= 1) {
        if (blocks == 1) run(0);
        return;
    }
    using Run = decltype(run);
    run_on_threads(blocks, &run, [](const void* own, std::int64_t block) {
        (*static_cast<const Run*>(own))(block);
    });
}

#else

/// Returns the number of threads that a loop of this thread may use.
inline int thread_count() {
    return omp_get_max_threads();
}

/// Calls f(i) for every i in [0, count), in any order, on this thread's OpenMP threads
/// (omp_get_max_threads). name: names the loop in the source; not used. f must not throw; kernels
/// report errors through their outputs. Blocks of `grain` indices stay on one thread.
template <typename F>
void parallel_for(const char* name, std::int64_t count, const F& f, std::int64_t grain = 256) {
    (void)name;
    const std::int64_t blocks = (count + grain - 1) / grain;
    if (blocks <= 1 || omp_in_parallel()) {
        for (std::int64_t i = 0; i < count; ++i)
            f(i);
        return;
    }
    const auto run = [&](std::int64_t block) {
        const std::int64_t end = std::min(count, (block + 1) * grain);
        for (std::int64_t i = block * grain; i < end; ++i)
            f(i);
    };
#if defined(__SANITIZE_THREAD__)
    // The thread sanitizer does not see the barriers of GCC's OpenMP library. Each thread gets its
    // blocks in advance: a shared counter would order the threads, and thereby hide their races.
    const int count_of_threads = omp_get_max_threads();
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < count_of_threads; ++thread)
        threads.emplace_back([&, thread] {
            omp_set_num_threads(1);
            for (std::int64_t block = thread; block < blocks; block += count_of_threads)
                run(block);
        });
#else
#pragma omp parallel for schedule(dynamic)
    for (std::int64_t block = 0; block < blocks; ++block)
        run(block);
#endif
}

/// RAII limit of OpenMP to one thread, for loops that the calling thread starts. Some libraries
/// choose the order of a sum by the number of available threads, even if the sum uses only one
/// thread.
class OneThread {
  public:
    OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
    ~OneThread() { omp_set_num_threads(before_); }
    OneThread(const OneThread&) = delete;
    OneThread& operator=(const OneThread&) = delete;

  private:
    int before_;
};

#endif

}  // namespace item3d
