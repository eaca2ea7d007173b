// Tests of what a model reads from images: differences between sentences, and attention to words.
#include "item3d/guidance/reading.h"

#include "tests/support/guidance.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

using testing::load_pipeline;

GuidanceInput one_image() {
    at::manual_seed(5);
    GuidanceInput input;
    input.images = at::rand({2, 3, 32, 32});
    return input;
}

TEST(Reading, SentencesThatAreTheSameMakeNoDifference) {
    const auto model = load_pipeline();
    const TextEmbedding red = model->encode_text({"a red cube"});
    const TextEmbedding blue = model->encode_text({"a blue cube"});
    const GuidanceInput input = one_image();
    const ReadingOptions options{.noises = 2};
    const at::Tensor none = prediction_difference(*model, input, red, red, options);
    EXPECT_EQ(none.abs().max().item<float>(), 0);
    const at::Tensor some = prediction_difference(*model, input, red, blue, options);
    EXPECT_EQ(some.dim(), 3);
    EXPECT_EQ(some.size(0), 2);
    EXPECT_EQ(some.size(1), 32 / model->downscale());
    EXPECT_GT(some.min().item<float>(), 0);
    EXPECT_TRUE(prediction_difference(*model, input, blue, red, options).equal(some));
    const ReadingOptions other{.noises = 2, .seed = 1};
    EXPECT_FALSE(prediction_difference(*model, input, red, blue, other).equal(some));
}

TEST(Reading, DifferencesAreClippedAboveOutliers) {
    const at::Tensor values = at::tensor({0.0f, 1.0f, 2.0f, 5.0f});
    EXPECT_TRUE(normalize_difference(values, 2, 2).allclose(at::tensor({0.0f, 0.25f, 0.5f, 1.0f})));
    EXPECT_EQ(normalize_difference(at::zeros({3}), 0, 4).max().item<float>(), 0);
}

TEST(Reading, AttentionIsSharedOutAmongTheTokens) {
    const auto model = load_pipeline();
    const at::Tensor attention =
        mean_attention(*model, one_image(), model->encode_text({"a red cube"}), {.noises = 2});
    ASSERT_EQ(attention.dim(), 4);
    EXPECT_EQ(attention.size(0), 2);
    EXPECT_EQ(attention.size(1), model->tokenizer().model_max_length());
    EXPECT_EQ(attention.size(2), 32 / model->downscale());
    EXPECT_TRUE(attention.sum(1).allclose(at::ones_like(attention.sum(1)), 1e-4, 1e-4));
    EXPECT_GT(attention.std(1).mean().item<float>(), 0);
}

}  // namespace
}  // namespace item3d
