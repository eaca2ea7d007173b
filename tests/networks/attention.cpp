#include "item3d/networks/layers/attention.h"

#include "tests/support/networks.h"

#include <cmath>

namespace item3d {
namespace {

at::Tensor exact_attention(const at::Tensor& query, const at::Tensor& key, const at::Tensor& value,
                           int heads) {
    const auto split = [&](const at::Tensor& x) {
        return x.to(at::kDouble).reshape({x.size(0), x.size(1), heads, -1}).transpose(1, 2);
    };
    const double scale = 1 / std::sqrt(static_cast<double>(query.size(2) / heads));
    const at::Tensor scores = at::matmul(split(query), split(key).transpose(2, 3)) * scale;
    return at::matmul(scores.softmax(-1), split(value)).transpose(1, 2).reshape(query.sizes());
}

struct AttentionCase {
    std::int64_t rows, queries, keys;
    int heads, width;
};

void compare_attention(const AttentionCase& shape, at::ScalarType dtype, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape.queries << " queries, " << shape.keys << " keys, "
                                      << shape.heads << " heads of " << shape.width);
    at::manual_seed(shape.queries);
    const std::int64_t channels = std::int64_t(shape.heads) * shape.width;
    // The scores are large, so their exponentials overflow unless the largest is subtracted first.
    const at::Tensor query = (8 * at::randn({shape.rows, shape.queries, channels})).to(dtype);
    const at::Tensor key = (8 * at::randn({shape.rows, shape.keys, channels})).to(dtype);
    const at::Tensor value = at::randn({shape.rows, shape.keys, channels}).to(dtype);
    const at::Tensor exact = exact_attention(query, key, value, shape.heads);
    const at::Tensor found = attention(query, key, value, shape.heads);
    EXPECT_EQ(found.scalar_type(), dtype);
    EXPECT_LT((found.to(at::kDouble) - exact).abs().max().item<double>(), tolerance);
}

TEST(Attention, IsTheFormula) {
    for (const auto& [dtype, tolerance] :
         {std::pair(at::kFloat, 1e-4), std::pair(at::kBFloat16, 2e-2)}) {
        compare_attention({2, 64, 64, 4, 32}, dtype, tolerance);
        compare_attention({1, 30, 77, 2, 40}, dtype, tolerance);    // keys of text
        compare_attention({3, 7, 1, 1, 6}, dtype, tolerance);       // one key, few channels
        compare_attention({1, 5, 130, 2, 160}, dtype, tolerance);   // several columns of channels
        compare_attention({1, 1100, 33, 1, 16}, dtype, tolerance);  // several ranges of queries
        compare_attention({1, 4, 9, 2, 5}, dtype, tolerance);  // an odd width, left to LibTorch
    }
}

TEST(Attention, IsTheSameOnOneThreadAndOnMany) {
    const at::Tensor x = at::randn({2, 40, 64});
    const at::Tensor one = attention(x, x, x, 2);
    at::set_num_threads(3);
    const at::Tensor many = attention(x, x, x, 2);
    at::set_num_threads(testing::test_threads());
    EXPECT_TRUE(at::equal(one, many));
}

}  // namespace
}  // namespace item3d
