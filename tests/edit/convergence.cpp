#include "item3d/edit/optimize/convergence.h"

#include "item3d/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace item3d {
namespace {

/// Returns lengths that fall exponentially from 1 to `floor` with the time constant `time`. Each is
/// multiplied by random noise between 0.3 and 1.7, as random timesteps cause it.
std::vector<float> curve(int count, double floor, double time, std::uint64_t seed) {
    Random random(seed, 1);
    std::vector<float> lengths;
    for (int i = 0; i < count; ++i) {
        const double length = floor + (1 - floor) * std::exp(-i / time);
        lengths.push_back(static_cast<float>(length * random.uniform(0.3, 1.7)));
    }
    return lengths;
}

}  // namespace

TEST(Convergence, IsFoundWhereTheDirectionHasFaded) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto converged = converged_at(curve(600, 0.1, 60, seed), 0.3);
        ASSERT_TRUE(converged) << seed;
        EXPECT_GE(*converged, 150);
        EXPECT_LT(*converged, 400);
    }
}

TEST(Convergence, IsNotFoundInNoise) {
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        EXPECT_FALSE(converged_at(curve(600, 1, 60, seed), 0.4)) << seed;
}

TEST(Convergence, WaitsWhileTheDirectionStillShrinks) {
    std::vector<float> lengths;
    for (int i = 0; i < 300; ++i)
        lengths.push_back(std::exp(-static_cast<float>(i) / 50));
    EXPECT_FALSE(converged_at(lengths, 0.5));
    lengths.insert(lengths.end(), 100, lengths.back());
    ASSERT_TRUE(converged_at(lengths, 0.5));
    EXPECT_GT(*converged_at(lengths, 0.5), 300);
}

TEST(Convergence, StaysWhereItWasFound) {
    const std::vector<float> lengths = curve(600, 0.1, 60, 3);
    const auto converged = converged_at(lengths, 0.3);
    ASSERT_TRUE(converged);
    const auto so_far = [&](std::int64_t count) {
        return converged_at({lengths.begin(), lengths.begin() + count}, 0.3);
    };
    EXPECT_FALSE(so_far(*converged - 1));
    EXPECT_EQ(so_far(*converged), converged);
    EXPECT_EQ(so_far(*converged + 50), converged);
}

TEST(Convergence, TakesItsTimeAndSurvivesWhatIsNotFinite) {
    std::vector<float> lengths(50, 1.0f);
    lengths.resize(149, 0.01f);
    EXPECT_FALSE(converged_at(lengths, 0.5));
    lengths.resize(200, 0.01f);
    lengths[40] = std::numeric_limits<float>::quiet_NaN();
    lengths[10] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(converged_at(lengths, 0.5), 150);
    EXPECT_FALSE(converged_at(lengths, 0));
    EXPECT_FALSE(converged_at({}, 0.5));
    EXPECT_FALSE(
        converged_at(std::vector<float>(200, std::numeric_limits<float>::quiet_NaN()), 0.5));
}

}  // namespace item3d
