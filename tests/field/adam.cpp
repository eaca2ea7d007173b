// Tests of Adam: agreement with LibTorch's on dense gradients, laziness on sparse ones, resumption.
#include "item3d/field/adam.h"

#include "item3d/core/error.h"

#include <gtest/gtest.h>
#include <torch/optim/adam.h>

#include <cmath>
#include <limits>

namespace item3d {
namespace {

TEST(Adam, MatchesTorchOnDenseGradients) {
    at::manual_seed(1);
    at::Tensor ours = at::randn({5, 3});
    at::Tensor theirs = ours.clone();
    ours.set_requires_grad(true);
    theirs.set_requires_grad(true);
    Adam adam;
    adam.add_group("group", {ours},
                   {.learning_rate = 0.05, .beta1 = 0.9, .beta2 = 0.99, .epsilon = 1e-8});
    torch::optim::Adam reference(
        {theirs}, torch::optim::AdamOptions(0.05).betas(std::make_tuple(0.9, 0.99)).eps(1e-8));
    const at::Tensor goal = at::randn({5, 3});
    for (int i = 0; i < 50; ++i) {
        adam.zero_grad();
        reference.zero_grad();
        (ours - goal).pow(4).sum().backward();
        (theirs - goal).pow(4).sum().backward();
        adam.step();
        reference.step();
    }
    EXPECT_LT((ours - theirs).abs().max().item<float>(), 1e-5f);
}

at::Tensor sparse_gradient(std::vector<std::int64_t> rows, const at::Tensor& values,
                           std::int64_t size) {
    const at::Tensor index = at::tensor(rows, at::kLong).unsqueeze(0);
    return at::sparse_coo_tensor(index, values, {size, values.size(1)});
}

TEST(Adam, TouchesOnlyTheRowsOfASparseGradient) {
    at::Tensor table = at::ones({6, 2}).set_requires_grad(true);
    Adam adam;
    adam.add_group("group", {table}, {.learning_rate = 0.1});
    table.mutable_grad() = sparse_gradient({1, 4}, at::full({2, 2}, 3.0f), 6);
    adam.step();
    for (int row = 0; row < 6; ++row) {
        const float wanted = row == 1 || row == 4 ? 0.9f : 1.0f;
        EXPECT_NEAR(table[row][0].item<float>(), wanted, 1e-5f) << row;
    }
    // A row's first update is a full step of the learning rate, at any iteration.
    for (int i = 0; i < 30; ++i) {
        table.mutable_grad() = sparse_gradient({1}, at::full({1, 2}, 3.0f), 6);
        adam.step();
    }
    table.mutable_grad() = sparse_gradient({2}, at::full({1, 2}, 1e-3f), 6);
    adam.step();
    EXPECT_NEAR(table[2][1].item<float>(), 0.9f, 1e-4f);
}

TEST(Adam, SkipsGradientsThatAreNotFiniteAndGivesUpAfterTen) {
    at::Tensor table = at::ones({6, 2}).set_requires_grad(true);
    at::Tensor bias = at::ones({3}).set_requires_grad(true);
    Adam adam;
    adam.add_group("table", {table}, {.learning_rate = 0.1});
    adam.add_group("bias", {bias}, {.learning_rate = 0.1});
    const auto step = [&](float row, float all) {
        table.mutable_grad() = sparse_gradient({1}, at::full({1, 2}, row), 6);
        bias.mutable_grad() = at::full({3}, all);
        adam.step();
    };
    const float infinity = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 9; ++i)
        i % 2 == 0 ? step(std::nanf(""), 1) : step(1, -infinity);
    EXPECT_TRUE(at::equal(table, at::ones({6, 2})));
    EXPECT_TRUE(at::equal(bias, at::ones({3})));
    step(1, 1);
    EXPECT_NEAR(table[1][0].item<float>(), 0.9f, 1e-5f);
    EXPECT_NEAR(bias[2].item<float>(), 0.9f, 1e-5f);
    // The step that succeeded begins the count again.
    for (int i = 0; i < 9; ++i)
        step(1, infinity);
    EXPECT_THROW(step(1, infinity), InputError);
}

TEST(Adam, StepsOfRowsAreMultipliedByTheirFactors) {
    at::Tensor table = at::ones({4, 2}).set_requires_grad(true);
    AdamOptions options{.learning_rate = 0.1};
    options.row_factors = at::tensor({1.0f, 0.5f, 0.0f, 1.0f});
    Adam adam;
    adam.add_group("group", {table}, options);
    table.mutable_grad() = sparse_gradient({0, 1, 2}, at::full({3, 2}, 3.0f), 4);
    adam.step();
    const std::vector<float> wanted{0.9f, 0.95f, 1.0f, 1.0f};
    for (int row = 0; row < 4; ++row)
        EXPECT_NEAR(table[row][1].item<float>(), wanted[static_cast<std::size_t>(row)], 1e-5f);
}

TEST(Adam, SumsRepeatedRows) {
    at::Tensor a = at::zeros({3, 1}).set_requires_grad(true);
    at::Tensor b = at::zeros({3, 1}).set_requires_grad(true);
    Adam adam;
    adam.add_group("group", {a, b}, {.learning_rate = 0.1, .epsilon = 1.0});
    a.mutable_grad() = sparse_gradient({2, 2}, at::ones({2, 1}), 3);
    b.mutable_grad() = sparse_gradient({2}, at::full({1, 1}, 2.0f), 3);
    adam.step();
    EXPECT_LT(a[2].item<float>(), 0.0f);
    EXPECT_TRUE(at::equal(a, b));
}

TEST(Adam, GoesOnFromASavedState) {
    const auto run = [](int stop) {
        at::Tensor x = at::tensor({1.0f, -2.0f, 0.5f, 3.0f}).view({2, 2}).set_requires_grad(true);
        auto adam = std::make_unique<Adam>();
        adam->add_group("group", {x}, {});
        for (int i = 0; i < 20; ++i) {
            if (i == stop) {
                std::map<std::string, at::Tensor> kept;
                for (const auto& [name, tensor] : adam->state())
                    kept[name] = tensor.clone();
                adam = std::make_unique<Adam>();
                adam->add_group("group", {x}, {});
                adam->load_state(kept);
            }
            adam->zero_grad();
            x.square().sum().backward();
            adam->step();
        }
        return x.detach();
    };
    EXPECT_TRUE(at::equal(run(-1), run(7)));
}

TEST(Adam, RefusesAStateThatDoesNotFit) {
    at::Tensor x = at::zeros({4, 2}).set_requires_grad(true);
    Adam adam;
    adam.add_group("group", {x}, {});
    EXPECT_THROW(adam.load_state({}), std::logic_error);
    auto state = adam.state();
    state["group.0.momentum"] = at::zeros({3, 2});
    EXPECT_THROW(adam.load_state(state), std::logic_error);
}

TEST(Adam, FindsGroupsByName) {
    at::Tensor a = at::zeros({2}).set_requires_grad(true);
    at::Tensor b = at::zeros({2}).set_requires_grad(true);
    Adam adam;
    adam.add_group("first", {a}, {.learning_rate = 0.1});
    adam.add_group("second", {b}, {.learning_rate = 0.1});
    adam.options("second").learning_rate = 0;
    (a + b).sum().backward();
    adam.step();
    EXPECT_LT(a[0].item<float>(), 0);
    EXPECT_EQ(b[0].item<float>(), 0);
    EXPECT_TRUE(adam.state().contains("second.0.momentum"));
    EXPECT_THROW(adam.options("third"), std::logic_error);
    EXPECT_THROW(adam.add_group("first", {b}, {}), std::logic_error);
}

}  // namespace
}  // namespace item3d
