// Counter-based random numbers: a value depends on (seed, stream, counter) alone, so results do not
// depend on threads and a resumed run draws what the interrupted one would have drawn.
#pragma once

#include <cmath>
#include <cstdint>

namespace item3d {

/// Mixes 64 bits (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// A stream of random numbers. Copying it copies its position; `counter` is its whole state.
class Random {
  public:
    /// Streams of one seed are independent: give each use (cameras, noise, ...) a stream of its
    /// own.
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t counter = 0)
        : key_(mix_bits(seed ^ mix_bits(stream + 0x632be59bd9b4e019ull))), counter_(counter) {}

    std::uint64_t bits() { return mix_bits(key_ ^ mix_bits(counter_++)); }
    std::uint64_t counter() const { return counter_; }

    /// Uniform in [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform integer in [0, count); count > 0.
    std::int64_t index(std::int64_t count) {
        return static_cast<std::int64_t>(uniform() * static_cast<double>(count));
    }
    bool chance(double probability) { return uniform() < probability; }
    /// Standard normal (Box-Muller; the second value is dropped so that state stays one counter).
    double normal() {
        const double u = 1.0 - uniform();
        const double v = uniform();
        return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
    }
    double normal(double mean, double deviation) { return mean + deviation * normal(); }

  private:
    std::uint64_t key_;
    std::uint64_t counter_;
};

}  // namespace item3d
