// Counter-based random numbers. A number depends only on (seed, stream, counter). So results do not
// depend on threads, and a resumed run draws the same numbers as an uninterrupted one.
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

/// Streams for a run's seed. Each use of random numbers has a stream of its own, so that no two
/// uses draw the same numbers. A change of a value here changes the results of its use. In the
/// comments, the folder that uses a stream stands before the colon.
enum class RandomStream : std::uint64_t {
    surface_means = 0,             ///< edit: points for a material's means
    noise = 1,                     ///< guidance: timestep and noise
    renoise = 5,                   ///< guidance: noise of the learned source's samples
    further_noise = 8,             ///< guidance: additional noise of methods
    spread = 6,                    ///< edit: offsets of the points of material lookups
    painting = 7,                  ///< edit: order of views in the detail stage's fit
    color_points = 9,              ///< edit: points of the colour regulariser
    reading = 10,                  ///< guidance: noise on images that a model reads
    baseline = 12,                 ///< baselines: noise of samplers
    study = 0x7374756479,          ///< study: names of images, attention items
    study_bootstrap = 0x626f6f74,  ///< study: resampled raters
    region = 0x726567696f6e,       ///< region: points for measuring a region
    field = 0x6669656c64,          ///< field: initial values of the neural texture
    fit = 0x666974,                ///< field: points of the fit
    metallic = 0x6d6574616c,       ///< field: points for the mean metallic
    view_order = 0x76696577,       ///< reconstruct: order of the photographs
    shape = 0x7368617065,          ///< reconstruct: search for a shape; generate: choice of one
    refinement = 0x726566696e65,   ///< reconstruct: materials and light
    chamfer = 0x6368616d,          ///< reconstruct: points for comparing two meshes
};

/// Streams for seeds that are mixed with an index, such as the iteration. A mixed seed differs from
/// the seed of a run, so these values may equal values of RandomStream (8 and 10 do).
enum class IndexedStream : std::uint64_t {
    cameras = 2,                 ///< edit: by iteration
    backgrounds = 3,             ///< edit: by iteration
    lights = 4,                  ///< edit: by iteration
    painting_cameras = 8,        ///< edit: by view of the detail stage
    region_cameras = 10,         ///< edit: by close-up
    region_looks = 11,           ///< edit: targets of close-ups
    study_pages = 0x7061676573,  ///< study: a participant's order and positions
};

/// Compile-time check of the streams. Two streams with the same value are duplicate cases, which
/// are an error. A stream without a case causes a warning.
constexpr bool is_listed(RandomStream stream) {
    switch (stream) {
        case RandomStream::surface_means:
        case RandomStream::noise:
        case RandomStream::renoise:
        case RandomStream::further_noise:
        case RandomStream::spread:
        case RandomStream::painting:
        case RandomStream::color_points:
        case RandomStream::reading:
        case RandomStream::baseline:
        case RandomStream::study:
        case RandomStream::study_bootstrap:
        case RandomStream::region:
        case RandomStream::field:
        case RandomStream::fit:
        case RandomStream::metallic:
        case RandomStream::view_order:
        case RandomStream::shape:
        case RandomStream::refinement:
        case RandomStream::chamfer:
            return true;
    }
    return false;
}
constexpr bool is_listed(IndexedStream stream) {
    switch (stream) {
        case IndexedStream::cameras:
        case IndexedStream::backgrounds:
        case IndexedStream::lights:
        case IndexedStream::painting_cameras:
        case IndexedStream::region_cameras:
        case IndexedStream::region_looks:
        case IndexedStream::study_pages:
            return true;
    }
    return false;
}
static_assert(is_listed(RandomStream::noise) && is_listed(IndexedStream::cameras));

/// A stream of random numbers. A copy continues from the same position; `counter` is the whole
/// state.
class Random {
  public:
    /// Streams of one seed are independent, so that each purpose (cameras, noise, ...) can have its
    /// own.
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t counter = 0)
        : key_(mix_bits(seed ^ mix_bits(stream + 0x632be59bd9b4e019ull))), counter_(counter) {}

    Random(std::uint64_t seed, RandomStream stream, std::uint64_t counter = 0)
        : Random(seed, static_cast<std::uint64_t>(stream), counter) {}
    Random(std::uint64_t seed, IndexedStream stream, std::uint64_t counter = 0)
        : Random(seed, static_cast<std::uint64_t>(stream), counter) {}

    std::uint64_t bits() { return mix_bits(key_ ^ mix_bits(counter_++)); }
    std::uint64_t counter() const { return counter_; }

    /// Returns a uniform number in [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Returns a uniform integer in [0, count). count must be above 0.
    std::int64_t index(std::int64_t count) {
        return static_cast<std::int64_t>(uniform() * static_cast<double>(count));
    }
    bool chance(double probability) { return uniform() < probability; }
    /// Returns a standard normal number by the method of Box and Muller. The method's second number
    /// is dropped, so that the state stays one counter.
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
