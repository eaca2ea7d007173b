// Tests of attention against its formula, softmax(q k^T / sqrt(width)) v, computed in double. The
// tests use each level of instructions that the processor has.
#include "item3d/kernels/cpu/attention/attention_kernel.h"
#include "tests/support/scalar_kernels.h"

#include <algorithm>

namespace item3d {
namespace {

using testing::AlignedMemory;

/// Result [rows, queries, heads * width], with a bound on the error of each number.
struct ScalarAttention {
    std::vector<double> value, error;
};

/// The bound is made of three terms. A score has an error of up to width u sum |q k|, where u is
/// the rounding of float; a weight has twice this error, relatively. Weights are rounded to Number.
/// Sums over keys are floats.
template <typename Number>
ScalarAttention scalar_attention(const AttentionShape& of, const std::vector<Number>& query,
                                 const std::vector<Number>& key, const std::vector<Number>& value) {
    ScalarAttention result;
    const double u = testing::rounding<float>, scale = 1 / std::sqrt(static_cast<double>(of.width));
    const auto at = [&](std::int64_t row, std::int64_t places, std::int64_t place,
                        std::int64_t head, std::int64_t c) {
        return static_cast<std::size_t>(((row * places + place) * of.heads + head) * of.width + c);
    };
    std::vector<double> scores(static_cast<std::size_t>(of.keys));
    for (std::int64_t row = 0; row < of.rows; ++row)
        for (std::int64_t i = 0; i < of.queries; ++i)
            for (std::int64_t head = 0; head < of.heads; ++head) {
                double magnitude = 0, total = 0;
                for (std::int64_t j = 0; j < of.keys; ++j) {
                    double score = 0, terms = 0;
                    for (std::int64_t c = 0; c < of.width; ++c) {
                        const double term = testing::widen(query[at(row, of.queries, i, head, c)]) *
                                            testing::widen(key[at(row, of.keys, j, head, c)]);
                        score += term;
                        terms += std::abs(term);
                    }
                    scores[static_cast<std::size_t>(j)] = scale * score;
                    magnitude = std::max(magnitude, scale * terms);
                }
                const double largest = *std::max_element(scores.begin(), scores.end());
                for (double& score : scores)
                    total += score = std::exp(score - largest);
                const double relative = 4 * static_cast<double>(of.width + 4) * u * magnitude +
                                        2 * static_cast<double>(of.keys + 8) * u +
                                        testing::rounding<Number>;
                for (std::int64_t c = 0; c < of.width; ++c) {
                    double sum = 0, size = 0;
                    for (std::int64_t j = 0; j < of.keys; ++j) {
                        const double term = scores[static_cast<std::size_t>(j)] / total *
                                            testing::widen(value[at(row, of.keys, j, head, c)]);
                        sum += term;
                        size += std::abs(term);
                    }
                    result.value.push_back(sum);
                    result.error.push_back(relative * size +
                                           2 * testing::rounding<Number> * std::abs(sum) + 1e-7);
                }
            }
    return result;
}

template <typename Number>
int compare_scalar_attention(const AttentionShape& of) {
    SCOPED_TRACE(::testing::Message() << of.queries << " queries, " << of.keys << " keys, "
                                      << of.heads << " heads of " << of.width);
    const std::int64_t channels = of.heads * of.width;
    const auto query = testing::random_numbers<Number>(of.rows * of.queries * channels, 1),
               key = testing::random_numbers<Number>(of.rows * of.keys * channels, 2),
               value = testing::random_numbers<Number>(of.rows * of.keys * channels, 3);
    const ScalarAttention expected = scalar_attention(of, query, key, value);
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const AttentionKernel<Number> kernel = attention_kernel<level, Number>();
        AlignedMemory scratch(kernel.scratch(of));
        std::vector<Number> result(query.size());
        const std::int64_t middle = std::min<std::int64_t>(of.queries, 7);
        for (std::int64_t row = 0; row < of.rows; ++row)
            for (std::int64_t head = 0; head < of.heads; ++head)
                for (const auto& [first, last] :
                     {std::pair(std::int64_t{0}, middle), {middle, of.queries}})
                    if (first < last)
                        kernel.attend(of, query.data(), key.data(), value.data(),
                                      {row, head, first, last}, result.data(), scratch.as<void>());
        for (std::size_t i = 0; i < result.size(); ++i)
            ASSERT_NEAR(testing::widen(result[i]), expected.value[i], expected.error[i])
                << "number " << i;
    });
}

TEST(ScalarAttention, IsTheFormula) {
    // Queries are computed in groups of six, keys in groups of 32, channels in columns of 64. The
    // shapes have complete and partial ones.
    const AttentionShape shapes[] = {
        {2, 3, 13, 77, 40}, {1, 2, 6, 32, 64}, {3, 1, 1, 1, 6}, {1, 2, 5, 130, 146}};
    for (const AttentionShape& of : shapes) {
        const int levels = compare_scalar_attention<float>(of);
        compare_scalar_attention<BFloat16>(of);
        if (levels == 0) GTEST_SKIP() << "no instructions for it";
    }
}

}  // namespace
}  // namespace item3d
