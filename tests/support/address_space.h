// A limit of memory for tests of programs that cannot start their threads.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <system_error>

namespace item3d::testing {

/// Exits with 0 if `start`, which starts at least 40 threads, throws std::system_error for lack of
/// address space for their stacks. For death tests.
template <typename Start>
[[noreturn]] void exit_after_lack_of_threads(const Start& start) {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t size = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (100 << 20);
    const rlimit limit{size, size};
    if (::setrlimit(RLIMIT_AS, &limit) != 0) std::_Exit(2);
    try {
        start();
    } catch (const std::system_error& error) {
        std::_Exit(error.code() == std::errc::resource_unavailable_try_again ? 0 : 3);
    }
    std::_Exit(1);
}

}  // namespace item3d::testing
