// Tests of the environment variables and error messages of processes that train together.
#include "tests/support/processes.h"

#include "item3d/core/error.h"
#include "item3d/prior/training/settings.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/processes/process_group.h"

#include <gtest/gtest.h>
#include <torch/nn/modules/linear.h>

#include <functional>

namespace item3d {
namespace {

/// Returns the message of the InputError, or a text that says what happened instead.
std::string input_error(const std::function<void()>& function) {
    try {
        function();
    } catch (const InputError& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("not an InputError: ") + error.what();
    }
    return "nothing was thrown";
}

TEST(PriorProcesses, ExchangeNumbersTextsAndTensors) {
    if (!testing::is_process()) {
        const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                             ("item3d_exchange_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
        for (const auto& result : testing::run_as_processes(folder))
            EXPECT_EQ(result.code, 0) << result.output;
        std::filesystem::remove_all(folder);
        return;
    }
    const ProcessGroup group = ProcessGroup::from_environment();
    ASSERT_EQ(group.size(), 2);
    const auto rank = static_cast<float>(group.rank());
    group.wait_for_first();
    at::manual_seed(4);
    const at::Tensor numbers = at::randn({2, 30011});
    at::Tensor sum = numbers[group.rank()].clone();
    group.sum(sum);
    EXPECT_TRUE(at::equal(sum, numbers[0] + numbers[1]));

    EXPECT_EQ(group.broadcast(group.first() ? "of the first" : "another"), "of the first");
    EXPECT_EQ(group.broadcast(std::string()), "");
    const NamedTensors got =
        group.broadcast(NamedTensors{{"half", at::full({2, 3}, 5 + rank, at::kHalf)},
                                     {"none", at::empty({0, 4})},
                                     {"long", at::scalar_tensor(7 + group.rank(), at::kLong)}});
    ASSERT_EQ(got.size(), 3u);
    EXPECT_TRUE(at::equal(got[0].second, at::full({2, 3}, 5, at::kHalf)));
    EXPECT_EQ(got[1].second.sizes(), (std::vector<std::int64_t>{0, 4}));
    EXPECT_EQ(got[2].second.item<std::int64_t>(), 7);

    const nlohmann::json settings{{"batch", 32 + group.rank()}, {"seed", 1}};
    const std::string message = input_error([&] { check_same_settings(group, settings); });
    if (group.first())
        EXPECT_EQ(message, "nothing was thrown");
    else
        EXPECT_NE(
            message.find(
                "process 1 of 2: has different settings than process 0: batch: 33 instead of 32;"),
            std::string::npos)
            << message;
    group.barrier();
}

/// A small training whose loss depends on the rows and on the global rank.
struct Toy {
    Toy(const std::filesystem::path& checkpoint, int count, const ProcessGroup& processes = {}) {
        options.label = "toy";
        options.checkpoint = checkpoint;
        options.samples = 80;
        options.rows = 16;
        options.batch = 4;
        options.processes = processes;
        for (int rank = 0; rank < count; ++rank) {
            at::manual_seed(5 + processes.rank());  // all ranks get process 0's values
            layers.emplace_back(70, 70);
        }
    }
    std::vector<LoopReplica> replicas() {
        std::vector<LoopReplica> result;
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const auto count = static_cast<int>(layers.size());
            const int rank = options.processes.rank() * count + static_cast<int>(i);
            result.push_back({{layers[i].ptr()}, [this, i, rank](const auto& rows, auto step) {
                                  if (step == dies_at && rank == 1) ::_exit(7);
                                  return loss(layers[i], rows, rank);
                              }});
        }
        return result;
    }
    static at::Tensor loss(torch::nn::Linear layer, const std::vector<std::int64_t>& rows,
                           int rank) {
        const at::Tensor columns = at::arange(70) + .5f * static_cast<float>(rank);
        const at::Tensor x = at::sin(at::tensor(rows).unsqueeze(1) * columns);
        return (layer(x) - x.flip(1)).square().mean();
    }
    void train(bool resume, std::int64_t stop_after = 0) {
        options.resume = resume;
        options.stop_after = stop_after;
        TrainingLoop(options, replicas()).run([](const auto&, const auto&) {});
    }

    LoopOptions options;
    std::vector<torch::nn::Linear> layers;
    std::int64_t dies_at = -1;
};

/// The results are equal also after stopping and resuming, after a stop request to only one
/// process, and without a shared folder.
TEST(PriorProcesses, TwoTrainAsTwoReplicasDo) {
    if (testing::is_process()) {
        const ProcessGroup processes = ProcessGroup::from_environment();
        const auto folder = testing::process_folder();
        const std::filesystem::path file =
            folder / (processes.first() ? "two.safetensors" : "nobody/none.safetensors");
        Toy toy(file, 1, processes);
        EXPECT_THROW(toy.train(false, processes.first() ? 0 : 24), Interrupted);
        Toy again(file, 1, processes);
        again.train(true);
        EXPECT_FALSE(std::filesystem::exists(folder / "nobody"));
        return;
    }
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("item3d_equal_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    Toy(folder / "one.safetensors", 2).train(false);
    for (const auto& result : testing::run_as_processes(folder))
        EXPECT_EQ(result.code, 0) << result.output;
    const auto one = SafeTensors::open(folder / "one.safetensors");
    const auto two = SafeTensors::open(folder / "two.safetensors");
    for (const char* name : {"values", "average", "first_moment", "second_moment", "steps"})
        EXPECT_TRUE(at::equal(one.tensor(name), two.tensor(name))) << name;
    EXPECT_EQ(two.tensor("record")[0].item<double>(), 80);
    std::filesystem::remove_all(folder);
}

TEST(PriorProcesses, AProcessThatDiesIsSaidAndTheCheckpointKept) {
    if (!testing::is_process()) {
        const std::filesystem::path folder =
            std::filesystem::temp_directory_path() / ("item3d_lost_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
        const auto results = testing::run_as_processes(folder);
        EXPECT_EQ(results[0].code, 0) << results[0].output;
        EXPECT_EQ(results[1].code, 7) << results[1].output;
        const auto checkpoint = SafeTensors::open(folder / "checkpoint.safetensors");
        EXPECT_EQ(checkpoint.tensor("steps").item<std::int64_t>(), 3);
        EXPECT_EQ(checkpoint.tensor("record")[0].item<double>(), 3 * 2 * 4);
        std::filesystem::remove_all(folder);
        return;
    }
    Toy toy(testing::process_folder() / "checkpoint.safetensors", 1,
            ProcessGroup::from_environment());
    toy.dies_at = 3;
    TrainingLoop loop(toy.options, toy.replicas());
    try {
        loop.run([](const auto&, const auto&) {});
        FAIL() << "nobody was missed";
    } catch (const LostProcess& error) {
        EXPECT_EQ(error.code(), ExitCode::no_resource);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("another process of this run ended"),
                  std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace item3d
