// Kernels are compiled for several sets of a processor's instructions; which of them run here.
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"

#include <cstdint>
#include <optional>
#include <type_traits>

// Clang 14, which builds the fuzz targets, does not know the names of all features: it does without
// the kernels.
#if defined(__x86_64__) && !defined(__clang__)
#define ITEM3D_HAS_VECTOR_KERNELS
#endif

namespace item3d {

/// Numbers that kernels take at a time.
constexpr std::int64_t register_numbers = 16;

inline std::int64_t whole_registers(std::int64_t count) {
    return (count + register_numbers - 1) / register_numbers * register_numbers;
}

enum class Instructions {
    none,
    avx2,    ///< with FMA and F16C: kernels for float, and for HalfFloat as floats
    avx512,  ///< F, BW, VL and DQ; BF16 too where BrainFloat is multiplied
};

/// What this processor has for kernels of float or BrainFloat, up to the level that ITEM3D_CPU
/// names in the environment: none, avx2, avx512, bf16 or amx. Results differ by rounding.
template <typename Number>
Instructions instructions_for();
template <>
Instructions instructions_for<float>();
template <>
Instructions instructions_for<BrainFloat>();

/// Whether it has matrix units for bfloat16 (AMX) and the system lets programs use them.
bool matrix_units_run();

/// What make.operator()<instructions>() gives for this processor's, asked once; nothing where it
/// has none. make: a lambda that captures nothing.
template <typename Number, typename Make>
const auto& kernel_for_this_processor([[maybe_unused]] const Make& make) {
    using Kernel = decltype(make.template operator()<Instructions::avx512>());
    static const std::optional<Kernel> found = [&]() -> std::optional<Kernel> {
#if defined(ITEM3D_HAS_VECTOR_KERNELS)
        const Instructions instructions = instructions_for<Number>();
        if (instructions == Instructions::avx512)
            return make.template operator()<Instructions::avx512>();
        if constexpr (std::is_same_v<Number, float>)
            if (instructions == Instructions::avx2)
                return make.template operator()<Instructions::avx2>();
#endif
        return std::nullopt;
    }();
    return found;
}

}  // namespace item3d
