// bfloat16 for files that know nothing of LibTorch.
#pragma once

#include <cstdint>

namespace item3d {

/// The upper half of a float's bits.
struct BrainFloat {
    std::uint16_t bits;
};

}  // namespace item3d
