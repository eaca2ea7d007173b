// 16-bit floating-point numbers for files without LibTorch.
#pragma once

#include <cstdint>

namespace item3d {

/// A number in bfloat16, which is the upper half of a float's bits.
struct BFloat16 {
    std::uint16_t bits;
};

/// A number in fp16, which is binary16 of IEEE 754.
struct Float16 {
    std::uint16_t bits;
};

}  // namespace item3d
