// The selection of the kernels for the processor. Each kernel is compiled for several instruction
// sets. The program uses the highest set that the processor has and that the environment variable
// ITEM3D_CPU allows.
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"

#include <cstdint>
#include <optional>
#include <type_traits>

// Clang 14, which builds the fuzz targets, does not know the names of all CPU features, so these
// builds have no vector kernels.
#if defined(__x86_64__) && !defined(__clang__)
#define ITEM3D_HAS_VECTOR_KERNELS
#endif

namespace item3d {

/// Number of floats that kernels process at a time.
constexpr std::int64_t register_numbers = 16;

inline std::int64_t whole_registers(std::int64_t count) {
    return (count + register_numbers - 1) / register_numbers * register_numbers;
}

enum class InstructionSet {
    none,
    avx2,    ///< with FMA and F16C; for float, and Float16 computed in float
    avx512,  ///< F, BW, VL and DQ, and BF16 for products of BFloat16
};

/// Returns this processor's instruction set for kernels of float or BFloat16. The environment
/// variable ITEM3D_CPU limits it: none, avx2, avx512, bf16 or amx. Results of different sets differ
/// in rounding.
template <typename Number>
InstructionSet instruction_set_for();
template <>
InstructionSet instruction_set_for<float>();
template <>
InstructionSet instruction_set_for<BFloat16>();

/// True if the processor has AMX for bfloat16, and the operating system enables it.
bool amx_available();

/// Returns the result of make.operator()<instructions>() for this processor's instruction set, or
/// no value if there is no kernel for this set. Later calls return the first call's result. make: a
/// lambda without captures.
template <typename Number, typename Make>
const auto& kernel_for_this_processor([[maybe_unused]] const Make& make) {
    using Kernel = decltype(make.template operator()<InstructionSet::avx512>());
    static const std::optional<Kernel> found = [&]() -> std::optional<Kernel> {
#if defined(ITEM3D_HAS_VECTOR_KERNELS)
        const InstructionSet instructions = instruction_set_for<Number>();
        if (instructions == InstructionSet::avx512)
            return make.template operator()<InstructionSet::avx512>();
        if constexpr (std::is_same_v<Number, float>)
            if (instructions == InstructionSet::avx2)
                return make.template operator()<InstructionSet::avx2>();
#endif
        return std::nullopt;
    }();
    return found;
}

}  // namespace item3d
