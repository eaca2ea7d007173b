// Tests of a prior's evaluation, with the shipped prior on a few images.
#include "item3d/prior/evaluation/evaluation.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/generate_defaults.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/prior/evaluation/classifier.h"
#include "item3d/prior/evaluation/evaluation_images.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace item3d {
namespace {

class PriorEvaluation : public ::testing::Test {
  protected:
    const std::filesystem::path folder_ =
        std::filesystem::path(ITEM3D_TEST_DATA) / "../../assets/prior";
    const Pipeline pipeline_ = Pipeline::load(folder_);
    const std::vector<ShapeView> views_ = make_views("mug", training_variants, 2, 1);
};

TEST_F(PriorEvaluation, ColorsAreToldApartOnAHeldOutMug) {
    MeasureOptions options;
    options.words = {"a", "red", "blue", "green", "white"};
    options.images = 2;
    const nlohmann::json measured = measure_prior(pipeline_, views_, options);
    ASSERT_EQ(measured["vocabulary"].size(), 1u);
    EXPECT_EQ(measured["kinds"]["colors"]["words"], 4);
    EXPECT_GE(measured["kinds"]["colors"]["accuracy"].get<double>(), .75);
    // The mug is a class of the training data, so no accuracy on new classes is reported.
    EXPECT_FALSE(measured["kinds"]["colors"].contains("on_new_classes"));
}

TEST_F(PriorEvaluation, OakIsNoRivalOfWood) {
    MeasureOptions options;
    options.words = {"a", "red", "blue", "oak", "wooden"};
    options.images = 2;
    const nlohmann::json measured = measure_prior(pipeline_, views_, options);
    EXPECT_EQ(measured["kinds"]["materials"]["words"], 2);
    EXPECT_EQ(measured["kinds"]["materials"]["accuracy"], 1.0);
}

TEST_F(PriorEvaluation, OtherImagesThanOursAreRefused) {
    namespace fs = std::filesystem;
    const fs::path copy = fs::temp_directory_path() / "item3d_prior_evaluation";
    fs::remove_all(copy);
    fs::copy(ITEM3D_TEST_DATA "/models/pipeline_sd", copy, fs::copy_options::recursive);
    auto config = nlohmann::json::parse(read_text(copy / "unet" / "config.json"));
    config["sample_size"] = 64;
    write_atomically(copy / "unet" / "config.json", config.dump());
    EXPECT_THROW(held_out_views(Pipeline::load(copy), 1, 1), InputError);
    fs::remove_all(copy);
}

TEST_F(PriorEvaluation, SamplesInAShapeAreKnownAgain) {
    const SampleGrid grid = draw_samples(folder_, pipeline_, {"mug", "red", "gold"}, 8, true, 3);
    EXPECT_EQ(grid.prompts, (std::vector<std::string>{"a red mug", "a golden mug"}));
    EXPECT_EQ(grid.images[0].width, 64);
    const nlohmann::json scores = score_samples(Clip::load(folder_ / clip_folder), grid);
    EXPECT_EQ(scores["pictures"], 2);
    EXPECT_EQ(scores["material_right"], 1.0);
}

TEST_F(PriorEvaluation, TheAutoencoderKeepsAImage) {
    const ReconstructionMeasure measure = measure_autoencoder(pipeline_, views_, 4, 5);
    EXPECT_GT(measure.psnr, 22);
    EXPECT_LT(measure.psnr, 45);
    EXPECT_LT(measure.object_psnr, measure.psnr);
    EXPECT_EQ(measure.reconstructions.size(), 4u);
}

TEST_F(PriorEvaluation, DefaultsAreThePriorsOwnForItsOwnScheduler) {
    const GenerateOptions own = generate_defaults(folder_, pipeline_);
    EXPECT_EQ(own.steps, 30);
    EXPECT_FLOAT_EQ(own.guidance_scale, 3.5f);
    // The recommended steps hold only for the folder's own scheduler.
    EXPECT_EQ(generate_defaults(folder_, pipeline_, "ddpm").steps, 250);
}

TEST(Evaluation, WordsThatWereNeverMeasuredCannotStay) {
    EvaluationOptions options;
    options.word_images = 0;
    const std::filesystem::path unmeasured = ITEM3D_TEST_DATA "/models/pipeline_sd";
    const auto output = std::filesystem::temp_directory_path() / "item3d_unmeasured";
    EXPECT_THROW(evaluate_prior(unmeasured, output, options), InputError);
    EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(EvaluationPage, ShowsTheWeakestWordsFirst) {
    const nlohmann::json evaluation{
        {"prior", "mine"},
        {"kinds", {{"colors", {{"words", 2}, {"accuracy", .5}, {"on_new_classes", .25}}}}},
        {"autoencoder", {{"psnr", 30.0}, {"object_psnr", 26.0}}},
        {"readers", nlohmann::json::object()},
        {"vocabulary",
         {{"colors",
           {{{"word", "red"}, {"accuracy", 1.0}},
            {{"word", "<teal>"}, {"accuracy", .0}, {"most_confused_with", "cyan"}}}}}}};
    const std::string page = evaluation_page(evaluation, {});
    EXPECT_NE(page.find("50 % of 2 words"), std::string::npos);
    EXPECT_NE(page.find("25 % on classes that were not trained on"), std::string::npos);
    EXPECT_LT(page.find("&lt;teal&gt;"), page.find(">red<"));
    EXPECT_NE(page.find("taken for cyan"), std::string::npos);
}

}  // namespace
}  // namespace item3d
