#include "item3d/guidance/guidance_stream.h"
#include "tests/fuzz/mutate.h"

#include <algorithm>

/// Reads requests for guidance one after the other.
ITEM3D_FUZZ_TARGET(guidance_request, data, size) {
    using namespace item3d;
    std::size_t at = 0;
    const auto read = [&](char* to, std::size_t wanted) {
        const std::size_t count = std::min(wanted, size - at);
        std::copy_n(data + at, count, to);
        at += count;
        return count;
    };
    return fuzz::read_or_refuse([&] {
        while (read_guidance_request(read)) {
        }
    });
}
