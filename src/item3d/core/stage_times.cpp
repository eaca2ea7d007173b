#include "item3d/core/stage_times.h"

#include <sys/resource.h>

namespace item3d {

std::int64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace item3d
