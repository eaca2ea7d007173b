// Tests of Muon's steps of matrices, and of these steps in replicas.
#include "item3d/prior/training/muon.h"

#include "item3d/prior/training/replicas.h"
#include "item3d/tensors/workers.h"

#include <gtest/gtest.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/embedding.h>
#include <torch/nn/modules/linear.h>

namespace item3d {
namespace {

TEST(Orthogonalize, SingularValuesBecomeAboutOne) {
    at::manual_seed(1);
    for (const auto& [rows, columns] : {std::pair{24, 24}, {16, 200}, {200, 16}}) {
        const at::Tensor step = newton_schulz(at::randn({rows, columns}) * 1e-4);
        ASSERT_EQ(step.sizes(), (std::vector<std::int64_t>{rows, columns}));
        // The median is tested, because the smallest singular value of a random square matrix may
        // be too small for five iterations.
        const at::Tensor values = std::get<1>(at::linalg_svd(step));
        EXPECT_LT(values.max().item<float>(), 1.3f) << rows;
        EXPECT_GT(values.median().item<float>(), .6f) << rows;
        if (rows != columns) {
            EXPECT_GT(values.min().item<float>(), .6f) << rows;
        }
    }
    EXPECT_EQ(newton_schulz(at::zeros({16, 32})).abs().max().item<float>(), 0);
}

struct WordNetwork : torch::nn::Module {
    torch::nn::Embedding embedding{nullptr};
    torch::nn::Conv2d convolution{nullptr};
    torch::nn::Linear head{nullptr};
    WordNetwork() {
        at::manual_seed(3);
        embedding = register_module("token_embedding", torch::nn::Embedding(40, 24));
        convolution = register_module("convolution", torch::nn::Conv2d(24, 16, 3));
        head = register_module("head", torch::nn::Linear(16, 1));
    }
    at::Tensor loss(const at::Tensor& words) {
        const auto x = embedding(words).permute({0, 3, 1, 2});
        return (head(at::tanh(convolution(x)).flatten(1)) - 1).square().mean();
    }
};

std::unique_ptr<FlatModel> flat_of(const std::shared_ptr<WordNetwork>& network) {
    return std::make_unique<FlatModel>(std::vector<std::shared_ptr<torch::nn::Module>>{network});
}

TEST(Orthogonalize, IsForHiddenWeightsAlone) {
    const auto flat = flat_of(std::make_shared<WordNetwork>());
    ASSERT_EQ(flat->matrices().size(), 1u);
    EXPECT_EQ(flat->matrices()[0].offset, 40 * 24);
    EXPECT_EQ(flat->matrices()[0].rows, 16);
    EXPECT_EQ(flat->matrices()[0].columns, 24 * 9);
}

TEST(Orthogonalize, TheFirstStepIsTheGradientsWithoutItsScale) {
    const auto network = std::make_shared<WordNetwork>();
    std::vector<std::unique_ptr<FlatModel>> flat;
    flat.push_back(flat_of(network));
    ReplicaGroup group(std::move(flat), {.weight_decay = 0, .orthogonal = true});
    // The gradient has full rank, because rounding would lift singular values that are almost zero.
    network->convolution->weight.mutable_grad().copy_(at::randn({16, 24, 3, 3}));
    const auto matrix = [](const at::Tensor& weight) {
        return weight.permute({0, 2, 3, 1}).reshape({16, -1}).clone();  // in memory order
    };
    const at::Tensor before = matrix(network->convolution->weight.detach());
    const at::Tensor step = newton_schulz(matrix(network->convolution->weight.grad())) *
                            orthogonal_step_scale(16, 24 * 9);
    group.step(0, {.learning_rate = .01f});
    const at::Tensor change = before - matrix(network->convolution->weight.detach());
    EXPECT_LT((change - step * .01).abs().max().item<float>(),
              .02 * change.abs().max().item<float>());
}

TEST(Orthogonalize, ReplicasStayEqual) {
    std::vector<std::shared_ptr<WordNetwork>> networks;
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (int rank = 0; rank < 2; ++rank) {
        networks.push_back(std::make_shared<WordNetwork>());
        flat.push_back(flat_of(networks.back()));
    }
    ReplicaGroup group(std::move(flat), {.orthogonal = true});
    const at::Tensor words = at::arange(36).view({4, 3, 3});
    double first = 0, last = 0;
    run_ranks(2, [&](int rank) {
        for (int step = 0; step < 20; ++step) {
            const auto loss = networks[static_cast<std::size_t>(rank)]->loss(
                words.slice(0, rank * 2, rank * 2 + 2));
            if (rank == 0) (step == 0 ? first : last) = loss.item<double>();
            loss.backward();
            group.step(rank, {.learning_rate = 1e-2f});
        }
    });
    EXPECT_TRUE(at::equal(group.replica(0).values, group.replica(1).values));
    EXPECT_LT(last, .1 * first);
}

}  // namespace
}  // namespace item3d
