// Tests of the hash grid: values, gradients against finite differences, and equal results on any
// number of threads.
#include "item3d/field/hash_grid.h"

#include "item3d/core/random.h"

#include <gtest/gtest.h>
#include <omp.h>

namespace item3d {
namespace {

at::Tensor random_tensor(std::vector<std::int64_t> shape, double low, double high,
                         std::uint64_t seed) {
    Random random(seed);
    at::Tensor tensor = at::empty(shape, at::kFloat);
    for (std::int64_t i = 0; i < tensor.numel(); ++i) {
        tensor.data_ptr<float>()[i] = static_cast<float>(random.uniform(low, high));
    }
    return tensor;
}

TEST(HashGrid, LevelsRiseGeometricallyAndCoarseOnesAreNotHashed) {
    const HashGrid grid = HashGrid::make(5, 2, 12, 8, 128);
    ASSERT_EQ(grid.levels.size(), 5u);
    EXPECT_EQ(grid.levels.front().resolution, 8);
    EXPECT_EQ(grid.levels[2].resolution, 32);
    EXPECT_EQ(grid.levels.back().resolution, 128);
    EXPECT_FALSE(grid.levels.front().hashed);
    EXPECT_EQ(grid.levels.front().entries, 9u * 9u * 9u);
    EXPECT_TRUE(grid.levels.back().hashed);
    EXPECT_EQ(grid.levels.back().entries, 4096u);
    EXPECT_EQ(grid.entries(), 729 + 4 * 4096);
}

TEST(HashGrid, InterpolatesALinearFunctionExactly) {
    // Each vertex of a dense level holds 2x - 3y + z + 0.5, which trilinear interpolation must
    // return.
    const HashGrid grid = HashGrid::make(1, 1, 14, 16, 16);
    at::Tensor table = at::empty({grid.entries(), 1});
    float* entry = table.data_ptr<float>();
    for (int z = 0; z <= 16; ++z) {
        for (int y = 0; y <= 16; ++y) {
            for (int x = 0; x <= 16; ++x) {
                *entry++ = (2.0f * static_cast<float>(x) - 3.0f * static_cast<float>(y) +
                            static_cast<float>(z)) /
                               16.0f +
                           0.5f;
            }
        }
    }
    const at::Tensor points = random_tensor({500, 3}, 0.0, 1.0, 1);
    const at::Tensor wanted =
        at::matmul(points, at::tensor({2.0f, -3.0f, 1.0f}).view({3, 1})) + 0.5f;
    EXPECT_LT((encode(grid, points, table) - wanted).abs().max().item<float>(), 1e-5f);
}

TEST(HashGrid, ClampsPointsOutsideTheCube) {
    const HashGrid grid = HashGrid::make(3, 2, 10, 4, 32);
    const at::Tensor table = random_tensor({grid.entries(), 2}, -1.0, 1.0, 2);
    const at::Tensor outside = at::tensor({-3.0f, 0.4f, 7.0f, 1.5f, -0.1f, 0.25f}).view({2, 3});
    EXPECT_TRUE(at::equal(encode(grid, outside, table), encode(grid, outside.clamp(0, 1), table)));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(at::isfinite(encode(grid, at::full({1, 3}, nan), table)).all().item<bool>());
}

class HashGridGradient : public ::testing::TestWithParam<int> {};

TEST_P(HashGridGradient, OfTheTableMatchesFiniteDifferences) {
    // The encoding is linear in the table, so finite differences are exact up to rounding for any
    // step.
    const HashGrid grid = HashGrid::make(4, GetParam(), 9, 3, 40);
    const at::Tensor points = random_tensor({60, 3}, -0.05, 1.05, 3);
    at::Tensor table = random_tensor({grid.entries(), grid.features}, -1.0, 1.0, 4);
    const at::Tensor weight = random_tensor({60, grid.output_width()}, -1.0, 1.0, 5);
    table.set_requires_grad(true);
    (encode(grid, points, table) * weight).sum().backward();
    ASSERT_TRUE(table.grad().is_sparse());
    const at::Tensor rows = table.grad()._indices().select(0, 0);
    ASSERT_TRUE((rows.diff() > 0).all().item<bool>());
    const at::Tensor gradient = table.grad().to_dense();
    const at::NoGradGuard no_grad;
    Random random(6);
    int nonzero = 0;
    for (int i = 0; i < 200; ++i) {
        const std::int64_t at = random.index(table.numel());
        at::Tensor moved = table.detach().clone();
        moved.view(-1)[at] += 0.5f;
        const float wanted =
            2.0f * ((encode(grid, points, moved) - encode(grid, points, table)) * weight)
                       .sum()
                       .item<float>();
        EXPECT_NEAR(gradient.view(-1)[at].item<float>(), wanted, 1e-4f);
        nonzero += wanted != 0.0f;
    }
    EXPECT_GT(nonzero, 20);
}

TEST_P(HashGridGradient, OfThePointsMatchesFiniteDifferences) {
    const HashGrid grid = HashGrid::make(3, GetParam(), 9, 3, 20);
    // The points are in the middle of the finest cells, so that the step crosses no lattice plane
    // of the finest level. Points that cross planes of coarser levels are sorted out below.
    at::Tensor points = random_tensor({200, 3}, 0.02, 0.98, 7);
    const at::Tensor table = random_tensor({grid.entries(), grid.features}, -1.0, 1.0, 8);
    const at::Tensor weight = random_tensor({200, grid.output_width()}, -1.0, 1.0, 9);
    points.set_requires_grad(true);
    (encode(grid, points, table) * weight).sum().backward();
    const at::Tensor gradient = points.grad();
    const at::NoGradGuard no_grad;
    const float step = 1e-3f;
    for (int axis = 0; axis < 3; ++axis) {
        at::Tensor offset = at::zeros({1, 3});
        offset[0][axis] = step;
        const at::Tensor difference =
            ((encode(grid, points + offset, table) - encode(grid, points - offset, table)) * weight)
                .sum(1) /
            (2.0f * step);
        int checked = 0;
        for (int i = 0; i < 200; ++i) {
            const float p = points[i][axis].item<float>();
            bool crosses = false;
            for (const HashGridLevel& level : grid.levels) {
                const float n = static_cast<float>(level.resolution);
                crosses = crosses || std::floor((p - step) * n) != std::floor((p + step) * n);
            }
            if (crosses) continue;
            ++checked;
            EXPECT_NEAR(gradient[i][axis].item<float>(), difference[i].item<float>(), 0.02f);
        }
        EXPECT_GT(checked, 100);
    }
}

INSTANTIATE_TEST_SUITE_P(Features, HashGridGradient, ::testing::Values(1, 2, 4, 8));

TEST(HashGrid, GradientsDoNotDependOnThreads) {
    const HashGrid grid = HashGrid::make(6, 4, 10, 8, 200);
    const at::Tensor weight = random_tensor({3000, grid.output_width()}, -1.0, 1.0, 10);
    const auto gradients = [&](int threads) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        at::Tensor points = random_tensor({3000, 3}, 0.0, 1.0, 11);
        at::Tensor table = random_tensor({grid.entries(), 4}, -1.0, 1.0, 12);
        points.set_requires_grad(true);
        table.set_requires_grad(true);
        (encode(grid, points, table) * weight).sum().backward();
        omp_set_num_threads(before);
        return std::make_pair(points.grad(), table.grad().to_dense());
    };
    const auto one = gradients(1);
    const auto three = gradients(3);
    EXPECT_TRUE(at::equal(one.first, three.first));
    EXPECT_TRUE(at::equal(one.second, three.second));
}

}  // namespace
}  // namespace item3d
