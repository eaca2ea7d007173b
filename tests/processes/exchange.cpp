// Tests of rows and gradients that several processes share.
#include "item3d/processes/gradients.h"
#include "item3d/processes/shared_rows.h"
#include "tests/support/processes.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

/// Runs the test in three processes and expects all of them to pass.
void expect_three(const std::string& name) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                         ("item3d_" + name + "_" + std::to_string(::getpid()));
    for (const auto& result : testing::run_as_processes(folder, 3))
        EXPECT_EQ(result.code, 0) << result.output;
    std::filesystem::remove_all(folder);
}

at::Tensor numbers(at::IntArrayRef sizes, int seed) {
    at::manual_seed(static_cast<std::uint64_t>(seed));
    return at::randn(sizes);
}

TEST(SharedRows, AreAllRowsOnEveryProcessWithTheSumOfTheirGradients) {
    if (!testing::is_process()) return expect_three("rows");
    const ProcessGroup group = ProcessGroup::from_environment();
    ASSERT_EQ(group.size(), 3);
    // The shares of 7 rows are 2, 2 and 3, those of 2 rows are 1, 1 and none.
    for (const std::int64_t total : {7, 2}) {
        const at::Tensor all = numbers({total, 5}, 3);
        const Share share = group.share(total);
        EXPECT_LE(share.count, (total + 2) / 3);
        at::Tensor own = all.narrow(0, share.first, share.count).clone().requires_grad_();
        const at::Tensor gathered = gather_rows(group, own, share.first, total);
        EXPECT_TRUE(at::equal(gathered.detach(), all));
        // Each process uses the rows differently.
        const at::Tensor seen = numbers({3, total, 5}, 4);
        (gathered * seen[group.rank()]).sum().backward();
        const at::Tensor wanted = seen.sum(0).narrow(0, share.first, share.count);
        EXPECT_TRUE(at::allclose(own.grad(), wanted, 1e-5, 1e-6));
    }
    const at::Tensor squares =
        compute_rows(group, 5, {2}, at::TensorOptions(), [](std::int64_t first, std::int64_t n) {
            return at::arange(first * 2, (first + n) * 2, at::kFloat).square().view({n, 2});
        });
    EXPECT_TRUE(at::equal(squares, at::arange(10, at::kFloat).square().view({5, 2})));
    EXPECT_TRUE(group.any(group.rank() == 2));
    EXPECT_FALSE(group.any(false));
    EXPECT_GT(group.exchange_seconds(), 0);
}

at::Tensor sparse_gradient(const std::vector<std::int64_t>& rows, float value) {
    const auto count = static_cast<std::int64_t>(rows.size());
    return at::_sparse_coo_tensor_unsafe(at::tensor(rows).unsqueeze(0), at::full({count, 2}, value),
                                         {10, 2}, at::TensorOptions().layout(at::kSparse));
}

TEST(SharedGradients, AreTheSumOfSparseAndDenseOnes) {
    if (!testing::is_process()) return expect_three("gradients");
    const ProcessGroup group = ProcessGroup::from_environment();
    const int rank = group.rank();
    at::Tensor table = at::zeros({10, 2}).requires_grad_();
    at::Tensor weights = at::zeros({4}).requires_grad_();
    at::Tensor alone = at::zeros({2}).requires_grad_();
    at::Tensor nobodys = at::zeros({3}).requires_grad_();
    // The rows of the table's gradient are unordered, and one occurs twice. The last process has
    // none.
    if (rank == 0) table.mutable_grad() = sparse_gradient({7, 1, 7}, 1);
    if (rank == 1) table.mutable_grad() = sparse_gradient({1, 3}, 10);
    weights.mutable_grad() = at::full({4}, static_cast<float>(rank + 1));
    if (rank == 2) alone.mutable_grad() = at::ones({2});
    sum_gradients(group, {table, weights, alone, nobodys});

    const at::Tensor& sum = table.grad();
    ASSERT_TRUE(sum.is_sparse());
    EXPECT_TRUE(at::equal(sum._indices()[0], at::tensor({1, 3, 7}, at::kLong)));
    EXPECT_TRUE(
        at::equal(sum._values(), at::tensor({11.f, 11.f, 10.f, 10.f, 2.f, 2.f}).view({3, 2})));
    EXPECT_TRUE(at::equal(weights.grad(), at::full({4}, 6.0f)));
    EXPECT_TRUE(at::equal(alone.grad(), at::ones({2})));
    EXPECT_FALSE(nobodys.grad().defined());
}

}  // namespace
}  // namespace item3d
