// Sums that many threads accumulate, in kernels that run on the CPU and on CUDA devices.
#pragma once

#include "item3d/core/host_device.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace item3d {

/// An array of sums. On the CPU only one thread adds to it. On a device many threads add
/// concurrently, in one of two ways:
///   - Atomics add floats to `values`. The result depends on the order of the threads.
///   - Two passes give a result that does not depend on the order. The first pass finds the largest
///     term of each sum (`largest`). The second pass adds the terms as 64-bit integers (`fixed`),
///     whose unit is 2^-bits times the power of two of the largest term. finish_sum() then converts
///     to float.
struct Accumulator {
    float* values = nullptr;
    std::uint32_t* largest = nullptr;     ///< for each sum, bits of its largest term's magnitude
    unsigned long long* fixed = nullptr;  ///< the sums as two's complement
    int bits = 0;

    ITEM3D_HOST_DEVICE bool wanted() const { return values != nullptr || largest != nullptr; }

    /// Returns the sums from `first` on.
    ITEM3D_HOST_DEVICE Accumulator from(std::int64_t first) const {
        return {values ? values + first : nullptr, largest ? largest + first : nullptr,
                fixed ? fixed + first : nullptr, bits};
    }

    /// Adds a term. On the host, concurrent calls for one sum are unsafe.
    ITEM3D_HOST_DEVICE void add(std::int64_t index, float value) const {
        if (values != nullptr)
            add_to(values[index], value);
        else
            add_in_passes(index, value);
    }

    /// Returns the exponent of a float's magnitude; for subnormal numbers, the exponent of the
    /// smallest normal number.
    ITEM3D_HOST_DEVICE static int exponent(std::uint32_t magnitude_bits) {
        const int biased = static_cast<int>(magnitude_bits >> 23);
        return (biased > 0 ? biased : 1) - 127;
    }
    /// True if the largest term is infinite or NaN.
    ITEM3D_HOST_DEVICE static bool overflows(std::uint32_t magnitude_bits) {
        return magnitude_bits >= 0x7f800000u;
    }

  private:
    // This is a separate function so that add() stays small enough to be inlined on the CPU.
#if !defined(__CUDACC__)
    __attribute__((cold, noinline))
#endif
    ITEM3D_HOST_DEVICE void
    add_in_passes(std::int64_t index, float value) const {
        if (fixed != nullptr)
            add_to(fixed[index], to_fixed(value, largest[index]));
        else
            raise_to(largest[index], magnitude(value));
    }
    ITEM3D_HOST_DEVICE static std::uint32_t magnitude(float value) {
        return std::bit_cast<std::uint32_t>(value) & 0x7fffffffu;
    }
    ITEM3D_HOST_DEVICE unsigned long long to_fixed(float value, std::uint32_t of_largest) const {
        if (overflows(of_largest)) return 0;
        const double scaled = std::ldexp(static_cast<double>(value), bits - exponent(of_largest));
        return static_cast<unsigned long long>(static_cast<long long>(std::rint(scaled)));
    }
    template <typename T>
    ITEM3D_HOST_DEVICE static void add_to(T& sum, T value) {
#if defined(__CUDA_ARCH__)
        atomicAdd(&sum, value);
#else
        sum += value;
#endif
    }
    ITEM3D_HOST_DEVICE static void raise_to(std::uint32_t& largest, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
        atomicMax(&largest, value);
#else
        if (value > largest) largest = value;
#endif
    }
};

/// Returns Accumulator::bits for sums of up to `terms` terms. It is the largest number of
/// fractional bits, up to 61, at which no sum overflows 64 bits, but at least 24.
inline int accumulator_bits(std::int64_t terms) {
    int bits = 61;
    while (bits > 24 && (terms >> (61 - bits)) > 0)
        --bits;
    return bits;
}

struct FinishSumsParameters {
    const std::uint32_t* largest;
    const unsigned long long* fixed;
    int bits;
    float* values;
};

/// Converts the sum of the second pass to float. The result is NaN if a term was NaN or infinite.
ITEM3D_HOST_DEVICE inline void finish_sum(const FinishSumsParameters& p, std::int64_t index) {
    const std::uint32_t largest = p.largest[index];
    const double sum = std::ldexp(static_cast<double>(static_cast<long long>(p.fixed[index])),
                                  Accumulator::exponent(largest) - p.bits);
    p.values[index] = Accumulator::overflows(largest) ? NAN : static_cast<float>(sum);
}

}  // namespace item3d
