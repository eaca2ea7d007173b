// 16-bit floating-point numbers for files without LibTorch.
#pragma once

#include <cstdint>

namespace item3d {

/// bfloat16: the upper half of a float's bits.
struct BFloat16 {
    std::uint16_t bits;
};

/// IEEE 754's binary16, fp16.
struct Float16 {
    std::uint16_t bits;
};

}  // namespace item3d
