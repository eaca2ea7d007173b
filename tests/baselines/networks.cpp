// Tests of the U-Nets of 9 and 8 input channels and their sampling loops against diffusers, and of
// guidance by images.
#include "tests/support/networks.h"

#include "item3d/baselines/clip_guidance.h"
#include "item3d/baselines/dataset_update.h"
#include "item3d/baselines/instruct.h"
#include "item3d/baselines/masked_sampling.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/samplers/sampler.h"

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;

nlohmann::json meta_of(const char* golden) {
    return nlohmann::json::parse(read_text(fixture(golden) / "meta.json"));
}

TEST(MaskedSampling, InpaintsAsDiffusersDoes) {
    const at::NoGradGuard no_grad;
    const Golden golden("pipeline_inpaint");
    const auto meta = meta_of("pipeline_inpaint");
    const std::string prompt = meta["prompt"][0], negative = meta["prompt"][1];
    const auto scale = meta["guidance"].get<float>();
    const Pipeline inpaint = Pipeline::load(fixture("pipeline_inpaint") / "inpaint");
    ASSERT_TRUE(is_inpainter(inpaint));
    const TemporaryFolder folder;
    fs::copy(fixture("pipeline_inpaint") / "inpaint", folder.path(), fs::copy_options::recursive);
    fs::copy(fixture("pipeline_inpaint") / "ordinary", folder.path(),
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    const Pipeline ordinary = Pipeline::load(folder.path());
    ASSERT_FALSE(is_inpainter(ordinary));

    MaskedSampling sampling;
    sampling.steps = meta["steps"].get<int>();
    sampling.image = golden.out("image_latents");
    sampling.noise = golden.in("noise");
    const at::Tensor mask = golden.out("latent_mask");
    for (const double strength : {1.0, 0.6}) {
        sampling.strength = strength;
        const std::string name = strength == 1 ? "1" : "0.6";
        sampling.drawn = nullptr;
        GuidedModel nine(inpaint, prompt, negative, scale);
        nine.condition = inpainting_condition(mask, golden.out("masked_image_latents"));
        golden.expect("inpaint_" + name + ".latents", sample_masked(nine, sampling), 2e-4);
        sampling.drawn = [&](int) { return mask; };
        const at::Tensor blended =
            sample_masked(GuidedModel(ordinary, prompt, negative, scale), sampling);
        golden.expect("ordinary_" + name + ".latents", blended, 2e-4);
        // With another network at some of the steps, the result differs.
        sampling.inpainter = &nine;
        sampling.inpaints = [](int step) { return step == 1; };
        const at::Tensor both =
            sample_masked(GuidedModel(ordinary, prompt, negative, scale), sampling);
        EXPECT_GT(largest_difference(both, blended), 1e-4);
        sampling.inpainter = nullptr;
    }
    EXPECT_EQ(ordinary.predicted_rows(), 2 * 2 * (5 + 3) - 2 * 2);
}

TEST(Instruct, PredictsAsDiffusersDoes) {
    const at::NoGradGuard no_grad;
    const Golden golden("pipeline_ip2p");
    const auto meta = meta_of("pipeline_ip2p");
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_ip2p"));
    const InstructScales scales{meta["guidance"].get<float>(), meta["image_guidance"].get<float>()};
    const at::Tensor image = golden.out("preprocessed") / 2 + 0.5;
    for (int i = 0; i < 2; ++i) {
        const std::string number = "_" + std::to_string(i);
        const InstructedModel model(pipeline, meta["prompts"][i][0], meta["prompts"][i][1], scales,
                                    "here");
        const at::Tensor latents = model.image_latents(image);
        golden.expect("image_latents", latents);
        for (int k = 0; k < 2; ++k) {
            const std::int64_t rows = pipeline.predicted_rows();
            const at::Tensor output =
                model(golden.in("noisy").narrow(0, k, 1), meta["timesteps"][k], latents);
            golden.expect("eps_guided" + number + "_" + std::to_string(k), output, 2e-4);
            EXPECT_EQ(pipeline.predicted_rows() - rows, 3);
        }
        const auto sampler = make_sampler(pipeline.schedule(), {meta["steps"].get<int>()});
        at::Tensor sample = golden.in("latents");
        for (int step = 0; step < sampler->steps(); ++step)
            sample = sampler->step(step, model(sample, sampler->timestep(step), latents), sample,
                                   at::Tensor());
        golden.expect("latents" + number, sample, 2e-4);
    }
    const at::Tensor a = at::full({1}, 3.0), b = at::full({1}, 2.0), c = at::full({1}, 0.5);
    EXPECT_NEAR(three_way(a, b, c, {7.5f, 1.5f}).item<double>(), 0.5 + 7.5 * 1 + 1.5 * 1.5, 1e-6);
}

TEST(Instruct, EditsAImageInTwentySteps) {
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_ip2p"));
    const InstructedModel model(pipeline, "turn it into gold", "", {}, "here");
    at::manual_seed(3);
    const at::Tensor image = at::rand({1, 3, 32, 32}), noise = at::randn({1, 4, 4, 4});
    const at::Tensor edited = model.edit(image, image, 700, 20, noise);
    EXPECT_EQ(pipeline.predicted_rows(), 60);  // 20 steps of three rows, as METHODS counts
    EXPECT_EQ(edited.sizes(), image.sizes());
    const at::Tensor soon = model.edit(image, image, 700, 4, noise);
    EXPECT_TRUE(model.edit(image, image, 700, 4, noise).equal(soon));
    EXPECT_GT(largest_difference(model.edit(image, 1 - image, 700, 4, noise), soon), 1e-4);
    // From the low noise level 8, the edit keeps more of the image than from level 999, which is
    // nearly pure noise.
    const at::Tensor decoded =
        (pipeline.decode_image(pipeline.encode_image(image * 2 - 1)) / 2 + 0.5).clamp(0, 1);
    const auto moved = [&](std::int64_t from) {
        return (model.edit(image, image, from, 4, noise) - decoded).abs().mean().item<double>();
    };
    EXPECT_LT(moved(8), 0.7 * moved(999));
}

TEST(Instruct, SaysWhichPriorFollowsNoInstructions) {
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const std::string message = message_of<InputError>(
        [&] { InstructedModel(pipeline, "turn it into gold", "", {}, "some/prior"); });
    EXPECT_NE(message.find("some/prior"), std::string::npos) << message;
    EXPECT_NE(message.find("4 input channels"), std::string::npos) << message;
    EXPECT_NE(message.find("timbrooks/instruct-pix2pix"), std::string::npos) << message;
}

TEST(DatasetUpdate, ViewsAreEditedInTurn) {
    std::vector<std::int64_t> edited;
    for (std::int64_t i = 0; i < 60; i += edit_rate)
        edited.push_back(dataset_views(1, i, 2, 4).front());
    EXPECT_EQ(edited, (std::vector<std::int64_t>{0, 1, 2, 3, 0, 1}));
    EXPECT_EQ(dataset_views(1, 7, 3, 4), dataset_views(1, 7, 3, 4));
    std::vector<int> seen(4);
    for (std::int64_t i = 1; i < 200; ++i)
        ++seen[static_cast<std::size_t>(dataset_views(1, i, 1, 4).front())];
    for (const int count : seen)
        EXPECT_GT(count, 25);
}

TEST(DatasetUpdate, LossIsThatOfPlainSums) {
    at::manual_seed(4);
    const at::Tensor a = at::rand({1, 1, 7, 7}), b = at::rand({1, 1, 7, 7});
    double sums[5] = {}, apart = 0;
    for (int i = 0; i < 49; ++i) {
        const double x = a.flatten()[i].item<double>(), y = b.flatten()[i].item<double>();
        sums[0] += x / 49;
        sums[1] += y / 49;
        sums[2] += x * x / 49;
        sums[3] += y * y / 49;
        sums[4] += x * y / 49;
        apart += std::abs(x - y) / 49;
    }
    const double va = sums[2] - sums[0] * sums[0], vb = sums[3] - sums[1] * sums[1],
                 covariance = sums[4] - sums[0] * sums[1];
    const double ssim = (2 * sums[0] * sums[1] + 1e-4) * (2 * covariance + 9e-4) /
                        ((sums[0] * sums[0] + sums[1] * sums[1] + 1e-4) * (va + vb + 9e-4));
    EXPECT_NEAR(photometric_loss(a, b).item<double>(), apart + 1 - ssim, 1e-5);
    EXPECT_NEAR(photometric_loss(a, a).item<double>(), 0, 1e-6);
}

TEST(DatasetUpdate, FollowsTheImageThatItEditedAndKeepsItInItsState) {
    const auto pipeline = std::make_shared<Pipeline>(Pipeline::load(fixture("pipeline_ip2p")));
    DatasetUpdateOptions options;
    options.instruction = "turn it into gold";
    options.views = 2;
    options.steps = 2;
    at::manual_seed(5);
    GuidanceInput input;
    input.images = at::rand({1, 3, 32, 32}).requires_grad_(true);
    input.reference = input.images.detach().clone();
    DatasetUpdate update(pipeline, options);
    // Nothing was edited yet, so the images are the model's own.
    EXPECT_EQ(update.step(input, 1).latents_gradient.abs().max().item<float>() > 1e-3, false);
    EXPECT_EQ(pipeline->predicted_rows(), 0);
    const GuidanceOutput output = update.step(input, 0);
    EXPECT_EQ(pipeline->predicted_rows(), 6);
    EXPECT_GT(output.latents_gradient.abs().max().item<float>(), 1e-4);
    EXPECT_TRUE(output.latents.is_same(input.images));
    ASSERT_EQ(update.state().size(), 1u);
    DatasetUpdate again(pipeline, options);
    again.load_state(update.state());
    EXPECT_TRUE(again.state()[0].second.equal(update.state()[0].second));
}

TEST(ClipGuidance, LossesAreTheirFormulas) {
    const auto unit = [](std::vector<float> values) {
        const at::Tensor t = at::tensor(values).view({1, -1});
        return t / t.norm();
    };
    const at::Tensor image = unit({1, 2, 0}), before = unit({2, 1, 0}), target = unit({0, 1, 1}),
                     source = unit({1, 0, 1});
    const auto loss = [&](ClipLoss kind) {
        return clip_losses(kind, image, before, target, source).item<double>();
    };
    EXPECT_NEAR(loss(ClipLoss::absolute), 1 - 2 / (std::sqrt(5.0) * std::sqrt(2.0)), 1e-6);
    // Both differences are multiples of (-1, 1, 0).
    EXPECT_NEAR(loss(ClipLoss::directional), 0, 1e-6);
    const at::Tensor same = before.detach().clone().requires_grad_();
    clip_losses(ClipLoss::directional, same, before, target, source).sum().backward();
    EXPECT_TRUE(at::isfinite(same.grad()).all().item<bool>());
    EXPECT_GT(same.grad().abs().max().item<float>(), 0);
}

}  // namespace
}  // namespace item3d::testing
