// Statistical tests of the counter-based generator. Bounds are five standard errors: a correct
// generator fails one of these tests about once in a million seeds, and the seeds are fixed.
#include "item3d/core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace item3d {
namespace {

constexpr int sample_count = 200'000;

TEST(Random, UniformHasMeanHalfAndVarianceOneTwelfth) {
    Random random(1);
    double sum = 0, sum_of_squares = 0;
    for (int i = 0; i < sample_count; ++i) {
        const double value = random.uniform();
        ASSERT_GE(value, 0.0);
        ASSERT_LT(value, 1.0);
        sum += value;
        sum_of_squares += value * value;
    }
    const double mean = sum / sample_count;
    EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / 12 / sample_count));
    EXPECT_NEAR(sum_of_squares / sample_count - mean * mean, 1.0 / 12,
                5 * std::sqrt(1.0 / 180 / sample_count));
}

TEST(Random, NormalHasTheRightMoments) {
    Random random(2);
    double sum = 0, sum_of_squares = 0, sum_of_fourths = 0;
    for (int i = 0; i < sample_count; ++i) {
        const double value = random.normal();
        sum += value;
        sum_of_squares += value * value;
        sum_of_fourths += value * value * value * value;
    }
    EXPECT_NEAR(sum / sample_count, 0.0, 5 * std::sqrt(1.0 / sample_count));
    EXPECT_NEAR(sum_of_squares / sample_count, 1.0, 5 * std::sqrt(2.0 / sample_count));
    EXPECT_NEAR(sum_of_fourths / sample_count, 3.0, 5 * std::sqrt(96.0 / sample_count));
    Random shifted(2);
    Random standard(2);
    EXPECT_DOUBLE_EQ(shifted.normal(3.0, 0.5), 3.0 + 0.5 * standard.normal());
}

// Chi-squared over 64 cells has 63 degrees of freedom, so its mean is 63 and its standard deviation
// sqrt(126) = 11.2.
TEST(Random, IndexIsEvenlySpread) {
    Random random(3);
    std::array<int, 64> histogram{};
    for (int i = 0; i < sample_count; ++i) {
        const std::int64_t cell = random.index(64);
        ASSERT_GE(cell, 0);
        ASSERT_LT(cell, 64);
        ++histogram[static_cast<std::size_t>(cell)];
    }
    const double expected = sample_count / 64.0;
    double chi_squared = 0;
    for (const int count : histogram) {
        chi_squared += (count - expected) * (count - expected) / expected;
    }
    EXPECT_LT(chi_squared, 63 + 5 * 11.2);
    EXPECT_GT(chi_squared, 63 - 5 * 11.2);
}

double correlation(Random a, Random b) {
    double sum = 0;
    for (int i = 0; i < sample_count; ++i)
        sum += (a.uniform() - 0.5) * (b.uniform() - 0.5);
    return sum / sample_count * 12;
}

TEST(Random, StreamsAndSeedsAreIndependent) {
    const double bound = 5 / std::sqrt(static_cast<double>(sample_count));
    EXPECT_NEAR(correlation(Random(7, 0), Random(7, 1)), 0.0, bound);
    EXPECT_NEAR(correlation(Random(7, 0), Random(8, 0)), 0.0, bound);
    // The counters are neighbours: one stream against itself, shifted by one.
    EXPECT_NEAR(correlation(Random(7, 0, 0), Random(7, 0, 1)), 0.0, bound);
    // The pair (seed, stream) must not collapse into a sum.
    EXPECT_NEAR(correlation(Random(7, 8), Random(8, 7)), 0.0, bound);
}

TEST(Random, FirstValuesOfManySeedsDiffer) {
    std::set<std::uint64_t> values;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        for (std::uint64_t stream = 0; stream < 10; ++stream) {
            values.insert(Random(seed, stream).bits());
        }
    }
    EXPECT_EQ(values.size(), 10'000u);
}

TEST(Random, CounterIsTheWholeState) {
    Random random(5, 3);
    for (int i = 0; i < 17; ++i)
        random.normal();
    Random resumed(5, 3, random.counter());
    for (int i = 0; i < 10; ++i)
        EXPECT_EQ(random.bits(), resumed.bits());
}

TEST(Random, ChanceHappensAsOftenAsAsked) {
    Random random(6);
    int count = 0;
    for (int i = 0; i < sample_count; ++i)
        count += random.chance(0.3) ? 1 : 0;
    EXPECT_NEAR(count, 0.3 * sample_count, 5 * std::sqrt(0.21 * sample_count));
    EXPECT_FALSE(random.chance(0.0));
    EXPECT_TRUE(random.chance(1.0));
}

}  // namespace
}  // namespace item3d
