// Tests of replicas that train together, on a small network.
#include "item3d/prior/training/replicas.h"

#include "item3d/core/error.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/render/cuda/module.h"
#include "item3d/tensors/workers.h"
#include "tests/support/address_space.h"

#include <gtest/gtest.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/pimpl.h>
#include <torch/nn/utils/clip_grad.h>
#include <torch/optim/adamw.h>

#include <barrier>
#include <memory>
#include <stdexcept>

namespace item3d {
namespace {

using testing::exit_after_lack_of_threads;

struct Network : torch::nn::Module {
    torch::nn::Conv2d convolution{nullptr};
    torch::nn::Linear linear{nullptr};
    Network() {
        at::manual_seed(3);
        convolution = register_module("convolution", torch::nn::Conv2d(2, 3, 3));
        linear = register_module("linear", torch::nn::Linear(12, 1));
    }
    at::Tensor loss(const at::Tensor& x) {
        return linear(at::tanh(convolution(x)).flatten(1)).square().mean();
    }
};

/// Must be queried first: LibTorch looks for devices only once.
const bool has_device = cuda::cuda_available();

/// Trains a network of matrices on `device`. Returns its values and their running average.
at::Tensor train_matrices(at::Device device, bool orthogonal) {
    at::manual_seed(4);
    torch::nn::Linear first(24, 32), second(32, 24);
    const at::Tensor batch = at::randn({8, 24});
    first->to(device);
    second->to(device);
    std::vector<std::unique_ptr<FlatModel>> flat;
    flat.push_back(std::make_unique<FlatModel>(
        std::vector<std::shared_ptr<torch::nn::Module>>{first.ptr(), second.ptr()}));
    ReplicaGroup group(std::move(flat), OptimizerOptions{.orthogonal = orthogonal});
    for (int step = 0; step < 4; ++step) {
        second->forward(at::tanh(first->forward(batch.to(device)))).square().mean().backward();
        group.step(0, {.learning_rate = 1e-2f, .ema_decay = .9f});
    }
    return at::stack({group.replica(0).values.cpu(), group.average().cpu()});
}

/// Trains `ranks` replicas for some steps on equal parts of the same batches.
at::Tensor train_toy(int ranks, int steps) {
    std::vector<std::shared_ptr<Network>> networks;
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (int rank = 0; rank < ranks; ++rank) {
        networks.push_back(std::make_shared<Network>());
        flat.push_back(std::make_unique<FlatModel>(
            std::vector<std::shared_ptr<torch::nn::Module>>{networks.back()}));
    }
    at::manual_seed(9);
    const at::Tensor batch = at::randn({8, 2, 4, 4});
    ReplicaGroup group(std::move(flat), OptimizerOptions{});
    run_ranks(ranks, [&](int rank) {
        const auto part = 8 / ranks;
        for (int step = 0; step < steps; ++step) {
            networks[static_cast<std::size_t>(rank)]
                ->loss(batch.slice(0, rank * part, (rank + 1) * part))
                .backward();
            group.step(rank, {.learning_rate = 1e-2f, .ema_decay = .9f});
        }
    });
    for (int rank = 1; rank < ranks; ++rank)
        EXPECT_TRUE(at::equal(group.replica(0).values, group.replica(rank).values));
    EXPECT_EQ(group.steps(), steps);
    return group.replica(0).values.clone();
}

TEST(PriorReplicas, AveragedGradientsAreThoseOfTheWholeBatch) {
    const at::Tensor one = train_toy(1, 5), two = train_toy(2, 5), four = train_toy(4, 5);
    EXPECT_LT((one - two).abs().max().item<float>(), 1e-5);
    EXPECT_LT((one - four).abs().max().item<float>(), 1e-5);
    EXPECT_TRUE(at::equal(two, train_toy(2, 5)));  // timing has no influence
}

TEST(PriorReplicas, ADeviceStepsAsTheCpu) {
    if (!has_device)
        GTEST_SKIP() << "no CUDA device, or no libtorch_cuda.so: nothing to compare the CPU with";
    for (const bool orthogonal : {false, true}) {
        const at::Tensor ours = train_matrices(at::kCPU, orthogonal);
        const at::Tensor theirs = train_matrices({at::kCUDA, 0}, orthogonal);
        // A device orthogonalizes matrices in bf16.
        EXPECT_LT((ours - theirs).abs().max().item<float>(), orthogonal ? 5e-3 : 1e-4);
    }
}

TEST(PriorReplicas, StepIsAdamW) {
    auto ours = std::make_shared<Network>(), reference = std::make_shared<Network>();
    std::vector<std::unique_ptr<FlatModel>> flat;
    flat.push_back(
        std::make_unique<FlatModel>(std::vector<std::shared_ptr<torch::nn::Module>>{ours}));
    ReplicaGroup group(std::move(flat), OptimizerOptions{.clip_norm = .05f});
    torch::optim::AdamW adam(reference->parameters(),
                             torch::optim::AdamWOptions(1e-2).betas({.9, .99}).weight_decay(.01));
    const at::Tensor batch = at::randn({4, 2, 4, 4});
    for (int step = 0; step < 4; ++step) {
        ours->loss(batch).backward();
        group.step(0, {.learning_rate = 1e-2f});
        adam.zero_grad();
        reference->loss(batch).backward();
        torch::nn::utils::clip_grad_norm_(reference->parameters(), .05);
        adam.step();
    }
    for (const auto& item : reference->named_parameters())
        EXPECT_LT((item.value() - ours->named_parameters()[item.key()]).abs().max().item<float>(),
                  1e-5)
            << item.key();
}

TEST(PriorReplicas, GradientsThatAreNotFiniteAreSkippedAndEndTheTrainingAfterTenSteps) {
    std::vector<std::shared_ptr<Network>> networks;
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (int rank = 0; rank < 2; ++rank) {
        networks.push_back(std::make_shared<Network>());
        flat.push_back(std::make_unique<FlatModel>(
            std::vector<std::shared_ptr<torch::nn::Module>>{networks.back()}));
    }
    ReplicaGroup group(std::move(flat), OptimizerOptions{});
    const at::Tensor before = group.replica(0).values.clone();
    const auto train = [&](int steps) {
        run_ranks(2, [&](int rank) {
            try {
                for (int step = 0; step < steps; ++step) {
                    // Only the second replica has a bad gradient.
                    const at::Tensor loss = networks[static_cast<std::size_t>(rank)]->loss(
                        at::full({4, 2, 4, 4}, rank == 1 ? 1e30f : 1.0f));
                    (rank == 1 ? loss * 1e30f * 1e30f : loss).backward();
                    group.step(rank, {.learning_rate = 1e-2f, .ema_decay = .9f});
                }
            } catch (...) {
                group.fail();
                throw;
            }
        });
    };
    train(9);
    EXPECT_TRUE(at::equal(group.replica(0).values, before));
    EXPECT_TRUE(at::equal(group.average(), before));
    EXPECT_EQ(group.replica(1).gradients.abs().max().item<float>(), 0);
    EXPECT_EQ(group.steps(), 9);
    EXPECT_THROW(train(2), InputError);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(PriorReplicas, RanksBeginOnlyIfAllCanBeStarted) {
    constexpr int ranks = 64;
    std::barrier together(ranks);
    EXPECT_EXIT(exit_after_lack_of_threads(
                    [&] { run_ranks(ranks, [&](int) { together.arrive_and_wait(); }); }),
                ::testing::ExitedWithCode(0), "");
}
#endif

TEST(PriorReplicas, AFailingRankDoesNotLeaveTheOthersWaiting) {
    std::vector<std::unique_ptr<FlatModel>> flat;
    for (int rank = 0; rank < 2; ++rank)
        flat.push_back(std::make_unique<FlatModel>(
            std::vector<std::shared_ptr<torch::nn::Module>>{std::make_shared<Network>()}));
    ReplicaGroup group(std::move(flat), OptimizerOptions{});
    EXPECT_THROW(run_ranks(2,
                           [&](int rank) {
                               try {
                                   group.step(rank, {});
                                   if (rank == 1) throw std::logic_error("broken");
                                   for (;;)
                                       group.step(rank, {});
                               } catch (...) {
                                   group.fail();
                                   throw;
                               }
                           }),
                 std::exception);
}

TEST(PriorLearningRate, RisesStaysAndFalls) {
    EXPECT_LT(learning_rate_part(0, 600000), .05);
    EXPECT_DOUBLE_EQ(learning_rate_part(10000, 600000), 1);
    // A longer training has the same plateau as a shorter one.
    EXPECT_DOUBLE_EQ(learning_rate_part(300000, 600000), learning_rate_part(300000, 900000));
    EXPECT_NEAR(learning_rate_part(510000, 600000), .5, 1e-9);
    EXPECT_NEAR(learning_rate_part(600000, 600000), .02, 1e-9);
}

}  // namespace
}  // namespace item3d
