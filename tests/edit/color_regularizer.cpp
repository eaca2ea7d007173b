#include "item3d/edit/optimize/color_regularizer.h"

#include "item3d/core/random.h"
#include "tests/support/edit.h"

#include <ATen/CPUGeneratorImpl.h>
#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

using testing::EditTest;

constexpr float scale = 0.25f;

at::Tensor random_rows(std::int64_t rows, std::int64_t columns, std::uint64_t stream) {
    auto generator = at::detail::createCPUGenerator(Random(1, stream).bits());
    return at::rand({rows, columns}, generator, at::kDouble);
}

/// Returns the objective whose gradient ColorRegularizer::backward() computes: the sum of the
/// Geman-McClure norms of all departures.
double unevenness(const at::Tensor& change, const at::Tensor& color) {
    const Departures found = departures(change, color, scale);
    const at::Tensor squared = found.values.square().sum(1);
    return (0.5 * squared / (1 + squared / (scale * scale))).sum().item<double>();
}

double spread(const Image& was, const Image& now) {
    double sum = 0, squares = 0;
    const auto count = static_cast<double>(was.pixels.size() / 3);
    for (std::size_t i = 0; i < was.pixels.size(); i += 3) {
        const double change = now.pixels[i + 2] - was.pixels[i + 2];
        sum += change;
        squares += change * change;
    }
    return std::sqrt(squares / count - sum / count * (sum / count));
}

}  // namespace

TEST(ColorRegularizer, FindsNothingInARecolouring) {
    const at::Tensor color = random_rows(500, 3, 1).round();
    const at::Tensor change =
        0.2 + color.mm(at::tensor({-0.9, 0.1, 0.0, 0.0, -0.5, 0.2, 0.1, 0.0, 0.3}, at::kFloat)
                           .view({3, 3})
                           .to(at::kDouble));
    const Departures found = departures(change, color, scale);
    EXPECT_LT(found.values.abs().max().item<double>(), 0.05);  // from the ridge penalty
    EXPECT_GT(found.weights.min().item<double>(), 0.9);
}

TEST(ColorRegularizer, FindsABlotchAndLetsAPartOfAnotherColourGo) {
    const at::Tensor color = at::full({1000, 3}, 0.5, at::kDouble);
    at::Tensor change = at::full({1000, 3}, 0.3, at::kDouble);
    change.narrow(0, 0, 100) += 0.05;   // a blotch, to be found
    change.narrow(0, 100, 100) -= 0.7;  // a part of another colour, to be left alone
    const Departures found = departures(change, color, scale);
    EXPECT_NEAR(found.values[0][0].item<double>(), 0.05, 0.01);
    EXPECT_GT(found.weights[0][0].item<double>(), 0.8);
    EXPECT_LT(found.weights[150][0].item<double>(), 0.01);
    EXPECT_NEAR(found.values[900][0].item<double>(), 0.0, 0.01);
}

TEST(ColorRegularizer, ItsGradientIsThatOfTheRobustNorm) {
    // The colour is constant, so that the ridge regression's penalty has no effect. The changes are
    // small, so that the repeated fits have converged.
    const at::Tensor color = at::full({64, 3}, 0.5, at::kDouble);
    const at::Tensor change = 0.1 * random_rows(64, 3, 3);
    const Departures found = departures(change, color, scale);
    const at::Tensor gradient = found.values * found.weights;
    for (const std::int64_t row : {0, 17, 63}) {
        constexpr double step = 1e-4;
        at::Tensor moved = change.clone();
        moved[row][1] += step;
        const double above = unevenness(moved, color);
        moved[row][1] -= 2 * step;
        const double below = unevenness(moved, color);
        const double expected = gradient[row][1].item<double>();
        EXPECT_NEAR((above - below) / (2 * step), expected, 0.02 * std::abs(expected) + 1e-4);
    }
}

TEST_F(EditTest, EvennessMakesTheChangeEven) {
    EditRequest edit = request("uneven", 12);
    edit_model(edit);
    const Image was = base_color_of(edit.model);
    const double uneven = spread(was, base_color_of(edit.output / "model.glb"));
    edit.output = folder_ / "even";
    change(edit, {{"evenness", 1e6f}});
    edit_model(edit);
    const double even = spread(was, base_color_of(edit.output / "model.glb"));
    EXPECT_LT(even, 0.7 * uneven);
    // If the target names detail, there is no regularizer.
    edit.output = folder_ / "detail";
    change(edit, {{"detail_words", {"blue"}}, {"detail", "off"}});
    edit_model(edit);
    EXPECT_DOUBLE_EQ(spread(was, base_color_of(edit.output / "model.glb")), uneven);
}

}  // namespace item3d
