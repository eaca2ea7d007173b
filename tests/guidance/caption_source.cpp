#include "item3d/guidance/caption_source.h"

#include "item3d/guidance/prediction.h"
#include "item3d/guidance/rdl.h"
#include "tests/support/guidance.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

using testing::load_pipeline;
using testing::random_input;
using testing::relative_error;

const std::string source_prompt = "a red toy duck";
const std::string target_prompt = "a blue toy duck";

/// Returns e(to) - e(from), one row.
at::Tensor difference(const Pipeline& pipeline, const std::string& from, const std::string& to) {
    return pipeline.encode_text({to}).states - pipeline.encode_text({from}).states;
}

std::vector<Caption> captions(const std::vector<std::string>& texts) {
    std::vector<Caption> result;
    for (const std::string& text : texts)
        result.push_back({text, true});
    return result;
}

CaptionSource make_source(std::shared_ptr<const Pipeline> pipeline,
                          const CaptionSourceOptions& options = {}) {
    return {std::move(pipeline), source_prompt, target_prompt, options};
}

}  // namespace

TEST(ObjectWords, AreThoseThatBothSentencesHave) {
    using Words = std::vector<std::string>;
    EXPECT_EQ(object_words("a Red mug", "a golden mug"), (Words{"mug"}));
    EXPECT_EQ(object_words("the toy duck on a table", "a wooden toy duck"), (Words{"toy", "duck"}));
    EXPECT_EQ(object_words("a mug", "gold"), (Words{"mug"}));
    EXPECT_TRUE(mentions("Two Mugs, on a table", {"mug"}));
    EXPECT_FALSE(mentions("a smug face", {"mug"}));
    EXPECT_FALSE(mentions("", {"mug"}));
}

TEST(CaptionSource, MovesByTheMeanDifferenceOfTheCaptionsEmbeddings) {
    const auto pipeline = load_pipeline();
    CaptionSourceOptions options;
    options.strength = 0.5f;
    const auto before = captions({"a red duck", "a red duck", "a duck"});
    const auto now = captions({"a green duck", "a red duck", "a table"});
    // The last caption does not mention the object, so its weight is a quarter.
    const at::Tensor expected = 0.5 / 3 *
                                (difference(*pipeline, "a red duck", "a green duck") +
                                 0.25 * difference(*pipeline, "a duck", "a table"));
    const double maximum =
        difference(*pipeline, source_prompt, target_prompt).norm().item<double>();
    ASSERT_LT(expected.norm().item<double>(), maximum);

    const auto shift = make_source(pipeline, options).shift(before, now);
    ASSERT_TRUE(shift);
    EXPECT_LT(relative_error(shift->states, expected), 1e-6);
    options.paper_sign = true;
    const auto paper = make_source(pipeline, options).shift(before, now);
    EXPECT_LT(relative_error(paper->states, -expected), 1e-6);
}

TEST(CaptionSource, MovesNoFartherThanToTheTarget) {
    const auto pipeline = load_pipeline();
    CaptionSourceOptions options;
    options.strength = 2;
    const auto shift = make_source(pipeline, options)
                           .shift(captions({"a red duck"}),
                                  captions({"seven purple ducks, very far away, in the fog"}));
    const double maximum =
        difference(*pipeline, source_prompt, target_prompt).norm().item<double>();
    ASSERT_TRUE(shift);
    EXPECT_NEAR(length_of(*shift), maximum, 1e-4 * maximum);
}

TEST(CaptionSource, HasNoUseForCaptionsThatAreEmptyOrCutOff) {
    const auto pipeline = load_pipeline();
    const CaptionSource source = make_source(pipeline);
    const auto before = captions({"a red duck", "a red duck"});
    EXPECT_FALSE(source.shift(before, captions({"", " ... "})));
    EXPECT_FALSE(source.shift(before, {{"duck duck duck", false}, {"duck", false}}));
    EXPECT_FALSE(source.shift(captions({"", ""}), before));
    // One of the two captions is good, so the weight is one half.
    const auto shift = source.shift(before, {{"a blue duck", true}, {"duck duck", false}});
    ASSERT_TRUE(shift);
    const at::Tensor expected = 0.5 * difference(*pipeline, "a red duck", "a blue duck");
    EXPECT_LT(relative_error(shift->states, expected), 1e-6);
}

TEST(RelativeDirection, GoesFromASourceThatWasShifted) {
    const auto pipeline = load_pipeline();
    GuidanceOptions options;
    options.adjust = Adjustment::caption;
    const auto guidance = make_guidance(pipeline, source_prompt, target_prompt, options);
    const GuidanceInput input = random_input(4);
    guidance->step(input, 0);
    EXPECT_EQ(guidance->text_direction()->angle, 0);
    EXPECT_EQ(guidance->text_direction()->length, 1);

    TextEmbedding shift{0.5 * difference(*pipeline, "a duck", "a green table")};
    guidance->shift_source(shift);
    const NoisedLatents start = noise_latents(*pipeline, input, options, 3);
    const TextEmbedding text = pipeline->encode_text({target_prompt, source_prompt});
    const PromptPair pair =
        predict_pair(*pipeline, start, text.row(0), {text.row(1).states + shift.states});
    const GuidanceOutput output = guidance->step(input, 3);
    EXPECT_LT(relative_error(output.latents_gradient,
                             start.weight * options.guidance_scale * (pair.target - pair.source)),
              1e-5);
    EXPECT_NEAR(output.source_loss, denoising_loss(*pipeline, pair.source, start).item<float>(),
                1e-5);

    const auto resumed = make_guidance(pipeline, source_prompt, target_prompt, options);
    resumed->load_state(guidance->state());
    EXPECT_TRUE(at::equal(resumed->step(input, 3).latents_gradient, output.latents_gradient));
    EXPECT_EQ(resumed->text_direction()->angle, guidance->text_direction()->angle);
    EXPECT_GT(guidance->text_direction()->angle, 1);
}

TEST(RelativeDirection, IsNothingWhereTheSourceHasComeToTheTarget) {
    const auto pipeline = load_pipeline();
    GuidanceOptions options;
    options.adjust = Adjustment::caption;
    const auto guidance = make_guidance(pipeline, source_prompt, target_prompt, options);
    guidance->shift_source({difference(*pipeline, source_prompt, target_prompt)});
    EXPECT_LT(guidance->step(random_input(4), 0).direction_length, 1e-5);
    EXPECT_LT(guidance->text_direction()->length, 1e-5);
}

TEST(TextDirection, IsMeasuredInDegreesAndPartsOfTheFirst) {
    const auto row = [](float x, float y) {
        return TextEmbedding{at::tensor({x, y}).view({1, 1, 2})};
    };
    const TextDirection turned = compare_directions(row(2, 0), row(0, 0), row(2, 1));
    EXPECT_NEAR(turned.angle, 90, 1e-6);
    EXPECT_NEAR(turned.length, 0.5, 1e-6);
    const TextDirection gone = compare_directions(row(2, 0), row(0, 0), row(2, 0));
    EXPECT_EQ(gone.angle, 0);
    EXPECT_EQ(gone.length, 0);
    EXPECT_EQ(compare_directions(row(2, 0), row(2, 0), row(1, 0)).length, 1);
}

}  // namespace item3d
