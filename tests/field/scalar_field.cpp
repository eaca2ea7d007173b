// The hash grid and the field's last activation against their formulas in double.
#include "item3d/field/hash_grid.h"
#include "item3d/field/kernels/bounded.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

/// Returns the features of one level at a point as in Mueller et al. 2022, section 3: the trilinear
/// interpolation of the entries of the cell's corners. Corners are numbered row by row, or hashed
/// by equation 4.
std::vector<double> scalar_level(const HashGridLevel& level, int features, const float* table,
                                 const std::vector<double>& point) {
    const double resolution = level.resolution;
    std::uint64_t cell[3];
    double fraction[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double scaled = std::clamp(point[axis], 0.0, 1.0) * resolution;
        cell[axis] = static_cast<std::uint64_t>(std::min(std::floor(scaled), resolution - 1));
        fraction[axis] = scaled - static_cast<double>(cell[axis]);
    }
    std::vector<double> sums(static_cast<std::size_t>(features));
    for (std::uint64_t dz = 0; dz < 2; ++dz)
        for (std::uint64_t dy = 0; dy < 2; ++dy)
            for (std::uint64_t dx = 0; dx < 2; ++dx) {
                const std::uint64_t x = cell[0] + dx, y = cell[1] + dy, z = cell[2] + dz;
                const auto side = static_cast<std::uint64_t>(level.resolution) + 1;
                // The products are modulo 2^32. The table's size is a power of two, which keeps
                // their lowest bits.
                const std::uint64_t entry =
                    level.hashed ? (x ^ y * 2654435761u ^ z * 805459861u) % level.entries
                                 : x + side * (y + side * z);
                const double weight = (dx != 0 ? fraction[0] : 1 - fraction[0]) *
                                      (dy != 0 ? fraction[1] : 1 - fraction[1]) *
                                      (dz != 0 ? fraction[2] : 1 - fraction[2]);
                for (std::size_t f = 0; f < sums.size(); ++f)
                    sums[f] += weight * table[(level.first + entry) * sums.size() + f];
            }
    return sums;
}

TEST(ScalarHashGrid, IsTheInterpolatedCornersOfDenseAndHashedLevels) {
    for (const int features : {1, 2, 4, 8}) {
        const HashGrid grid = HashGrid::make(5, features, 9, 3, 60);
        EXPECT_FALSE(grid.levels.front().hashed);
        EXPECT_TRUE(grid.levels.back().hashed);
        at::manual_seed(51);
        const at::Tensor points = at::rand({101, 3}) * 1.2f - 0.1f;
        const at::Tensor table = at::rand({grid.entries(), features}) * 2 - 1;
        const at::Tensor found = encode(grid, points, table);
        for (std::int64_t i = 0; i < 101; ++i) {
            const float* p = points.const_data_ptr<float>() + 3 * i;
            std::int64_t column = 0;
            for (const HashGridLevel& level : grid.levels)
                for (const double expected : scalar_level(
                         level, features, table.const_data_ptr<float>(), {p[0], p[1], p[2]}))
                    // Fractions of up to 60 cells have errors of 4e-6 in float, and entries differ
                    // by up to 2.
                    ASSERT_NEAR(found[i][column++].item<double>(), expected, 2e-5) << i;
        }
    }
}

TEST(ScalarBounded, IsASigmoidBeyondTheRangeClampedWithItsSlope) {
    const float in[] = {-30, -3, -0.4f, 0, 0.1f, 2, 3.5f, 30}, low[] = {0, -1}, high[] = {1, 2};
    std::vector<float> out(8), gradient(8), ones(8, 1.0f);
    BoundedParameters p{in, low, high, ones.data(), 2, out.data()};
    for (std::int64_t i = 0; i < 8; ++i)
        bounded_forward(p, i);
    p.out = gradient.data();
    for (std::int64_t i = 0; i < 8; ++i)
        bounded_backward(p, i);
    for (std::size_t i = 0; i < 8; ++i) {
        const double begin = low[i % 2], end = high[i % 2], span = end - begin;
        // The range is 5 % wider at each end.
        const auto wide = [&](double x) {
            return begin - 0.05 * span + 1.1 * span / (1 + std::exp(-x));
        };
        EXPECT_NEAR(out[i], std::clamp(wide(in[i]), begin, end), 2e-6);
        // The gradient is that without the clamp.
        EXPECT_NEAR(gradient[i], (wide(in[i] + 1e-4) - wide(in[i] - 1e-4)) / 2e-4, 2e-6);
    }
}

}  // namespace
}  // namespace item3d
