#include "item3d/networks/vision_language/decoding.h"

#include "tests/support/networks.h"

namespace item3d {
namespace {

/// Language model whose next token depends only on the last one. It records what each row has read.
class Chain : public LanguageModelState {
  public:
    explicit Chain(at::Tensor probabilities) : logits_(probabilities.log()) {}
    at::Tensor read(const at::Tensor& tokens) override {
        read_ = read_.defined() ? at::cat({read_, tokens}, 1) : tokens;
        return logits_.index_select(0, tokens.select(1, tokens.size(1) - 1));
    }
    void select(const at::Tensor& rows) override { read_ = read_.index_select(0, rows); }
    at::Tensor read_;

  private:
    at::Tensor logits_;
};

constexpr int end_of_text = 3;

/// Returns a language with two ways from token 0. The way over 1 is likelier but has many ends; the
/// way over 2 has one.
at::Tensor garden_path() {
    return at::tensor({0.001, 0.599, 0.399, 0.001, 0.300, 0.200, 0.200, 0.300, 0.001, 0.001, 0.001,
                       0.997, 0.25, 0.25, 0.25, 0.25},
                      at::kFloat)
        .view({4, 4});
}

DecodingOptions search(int beams, int tokens) {
    DecodingOptions result;
    result.beams = beams;
    result.max_new_tokens = tokens;
    result.end_token = end_of_text;
    result.pad_token = 1;
    return result;
}

TEST(Decoding, GreedyTakesTheLikeliestAndPads) {
    const at::Tensor steps =
        at::tensor({0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0},
                   at::kFloat)
            .view({4, 4});
    Chain chain(steps);
    const Decoded decoded = decode(chain, at::tensor({0, 2}, at::kLong).view({2, 1}), search(1, 5));
    EXPECT_TRUE(decoded.tokens.equal(at::tensor({0, 1, 2, 3, 2, 3, 1, 1}, at::kLong).view({2, 4})));
    EXPECT_FALSE(decoded.scores.defined());
}

TEST(Decoding, StopsAtTheLongestText) {
    const at::Tensor repeats = at::eye(4);
    Chain chain(repeats);
    EXPECT_TRUE(decode(chain, at::tensor({0, 1}, at::kLong).view({1, 2}), search(1, 3))
                    .tokens.equal(at::tensor({0, 1, 1, 1, 1}, at::kLong).view({1, 5})));
}

TEST(Decoding, BeamsFindTheLikelierText) {
    Chain greedy(garden_path()), beams(garden_path());
    const at::Tensor prompt = at::tensor({0}, at::kLong).view({1, 1});
    EXPECT_EQ(decode(greedy, prompt, search(1, 2)).tokens[0][1].item<int>(), 1);
    const Decoded best = decode(beams, prompt, search(2, 2));
    EXPECT_TRUE(best.tokens.equal(
        at::tensor({std::int64_t{0}, std::int64_t{2}, std::int64_t{end_of_text}}).view({1, 3})));
    EXPECT_NEAR(best.scores.item<double>(), std::log(0.399 * 0.997) / 2, 1e-5);
    // The state's rows followed the beams, so the model read the winner's own past.
    EXPECT_EQ(beams.read_.size(0), 2);
}

TEST(Decoding, EachRowOfABatchIsDecodedByItself) {
    at::manual_seed(8);
    const at::Tensor language = at::rand({6, 6}).softmax(-1);
    for (const int width : {1, 3}) {
        DecodingOptions wanted = search(width, 6);
        Chain together(language);
        const at::Tensor prompts = at::tensor({0, 1, 4}, at::kLong).view({3, 1});
        const at::Tensor all = decode(together, prompts, wanted).tokens;
        for (int i = 0; i < 3; ++i) {
            Chain alone(language);
            const at::Tensor one = decode(alone, prompts.narrow(0, i, 1), wanted).tokens[0];
            EXPECT_TRUE(all[i].narrow(0, 0, one.size(0)).equal(one)) << width << " " << i;
        }
    }
}

/// Language model of which half the rows follow one language and half another. Both halves read the
/// same text.
class TwoReaders : public LanguageModelState {
  public:
    TwoReaders(const at::Tensor& first, const at::Tensor& second)
        : first_(first), second_(second) {}
    at::Tensor read(const at::Tensor& tokens) override {
        const auto halves = tokens.chunk(2, 0);
        EXPECT_TRUE(halves[0].equal(halves[1]));
        return at::cat({first_.read(halves[0]), second_.read(halves[1])});
    }
    void select(const at::Tensor& rows) override {
        const auto halves = rows.chunk(2, 0);
        first_.select(halves[0]);
        second_.select(halves[1] - (halves[1] - halves[0])[0]);
    }

  private:
    Chain first_, second_;
};

TEST(Decoding, TogetherRowsWriteTheTextThatIsLikeliestForAll) {
    at::manual_seed(3);
    const at::Tensor one = at::rand({6, 6}).softmax(-1), other = at::rand({6, 6}).pow(3);
    const at::Tensor mean = (one.log() / 2 + (other / other.sum(1, true)).log() / 2).exp();
    for (const int width : {1, 3}) {
        DecodingOptions wanted = search(width, 6);
        Chain both(mean);
        const at::Tensor expected =
            decode(both, at::tensor({0}, at::kLong).view({1, 1}), wanted).tokens;
        TwoReaders readers(one, other);
        wanted.together = true;
        EXPECT_TRUE(decode(readers, at::tensor({0, 0}, at::kLong).view({2, 1}), wanted)
                        .tokens.equal(expected))
            << width;
    }
}

}  // namespace
}  // namespace item3d
