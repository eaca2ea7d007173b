// Adam: agreement with LibTorch's on dense gradients, laziness on sparse ones, resumption.
#include "item3d/field/adam.h"

#include <gtest/gtest.h>
#include <torch/optim/adam.h>

namespace item3d {
namespace {

TEST(Adam, MatchesTorchOnDenseGradients) {
    torch::manual_seed(1);
    torch::Tensor ours = torch::randn({5, 3});
    torch::Tensor theirs = ours.clone();
    ours.set_requires_grad(true);
    theirs.set_requires_grad(true);
    Adam adam;
    adam.add_group({ours}, {.learning_rate = 0.05, .beta1 = 0.9, .beta2 = 0.99, .epsilon = 1e-8});
    torch::optim::Adam reference(
        {theirs}, torch::optim::AdamOptions(0.05).betas(std::make_tuple(0.9, 0.99)).eps(1e-8));
    const torch::Tensor goal = torch::randn({5, 3});
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

torch::Tensor sparse_gradient(std::vector<std::int64_t> rows, const torch::Tensor& values,
                              std::int64_t size) {
    const torch::Tensor index = torch::tensor(rows, torch::kInt64).unsqueeze(0);
    return torch::sparse_coo_tensor(index, values, {size, values.size(1)});
}

TEST(Adam, TouchesOnlyTheRowsOfASparseGradient) {
    torch::Tensor table = torch::ones({6, 2}).set_requires_grad(true);
    Adam adam;
    adam.add_group({table}, {.learning_rate = 0.1});
    table.mutable_grad() = sparse_gradient({1, 4}, torch::full({2, 2}, 3.0f), 6);
    adam.step();
    for (int row = 0; row < 6; ++row) {
        const float wanted = row == 1 || row == 4 ? 0.9f : 1.0f;
        EXPECT_NEAR(table[row][0].item<float>(), wanted, 1e-5f) << row;
    }
    // A row's first update is a full step of the learning rate, however late it comes.
    for (int i = 0; i < 30; ++i) {
        table.mutable_grad() = sparse_gradient({1}, torch::full({1, 2}, 3.0f), 6);
        adam.step();
    }
    table.mutable_grad() = sparse_gradient({2}, torch::full({1, 2}, 1e-3f), 6);
    adam.step();
    EXPECT_NEAR(table[2][1].item<float>(), 0.9f, 1e-4f);
}

TEST(Adam, StepsOfRowsAreMultipliedByTheirFactors) {
    torch::Tensor table = torch::ones({4, 2}).set_requires_grad(true);
    AdamOptions options{.learning_rate = 0.1};
    options.row_factors = torch::tensor({1.0f, 0.5f, 0.0f, 1.0f});
    Adam adam;
    adam.add_group({table}, options);
    table.mutable_grad() = sparse_gradient({0, 1, 2}, torch::full({3, 2}, 3.0f), 4);
    adam.step();
    const std::vector<float> wanted{0.9f, 0.95f, 1.0f, 1.0f};
    for (int row = 0; row < 4; ++row)
        EXPECT_NEAR(table[row][1].item<float>(), wanted[static_cast<std::size_t>(row)], 1e-5f);
}

TEST(Adam, SumsRepeatedRows) {
    torch::Tensor a = torch::zeros({3, 1}).set_requires_grad(true);
    torch::Tensor b = torch::zeros({3, 1}).set_requires_grad(true);
    Adam adam;
    adam.add_group({a, b}, {.learning_rate = 0.1, .epsilon = 1.0});
    a.mutable_grad() = sparse_gradient({2, 2}, torch::ones({2, 1}), 3);
    b.mutable_grad() = sparse_gradient({2}, torch::full({1, 1}, 2.0f), 3);
    adam.step();
    EXPECT_LT(a[2].item<float>(), 0.0f);
    EXPECT_TRUE(torch::equal(a, b));
}

TEST(Adam, GoesOnFromASavedState) {
    const auto run = [](int stop) {
        torch::Tensor x = torch::tensor({{1.0f, -2.0f}, {0.5f, 3.0f}}).set_requires_grad(true);
        auto adam = std::make_unique<Adam>();
        adam->add_group({x}, {});
        for (int i = 0; i < 20; ++i) {
            if (i == stop) {
                std::map<std::string, torch::Tensor> kept;
                for (const auto& [name, tensor] : adam->state())
                    kept[name] = tensor.clone();
                adam = std::make_unique<Adam>();
                adam->add_group({x}, {});
                adam->load_state(kept);
            }
            adam->zero_grad();
            x.square().sum().backward();
            adam->step();
        }
        return x.detach();
    };
    EXPECT_TRUE(torch::equal(run(-1), run(7)));
}

TEST(Adam, RefusesAStateThatDoesNotFit) {
    torch::Tensor x = torch::zeros({4, 2}).set_requires_grad(true);
    Adam adam;
    adam.add_group({x}, {});
    EXPECT_THROW(adam.load_state({}), std::logic_error);
    auto state = adam.state();
    state["0.0.momentum"] = torch::zeros({3, 2});
    EXPECT_THROW(adam.load_state(state), std::logic_error);
}

}  // namespace
}  // namespace item3d
