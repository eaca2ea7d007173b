#include "item3d/networks/diffusion/pipeline.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/generate.h"
#include "item3d/networks/diffusion/running_pipeline.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

GenerateOptions options_of(const Golden& golden, int index) {
    const auto meta = nlohmann::json::parse(read_text(fixture("pipeline_sd") / "meta.json"));
    GenerateOptions options;
    options.prompt = meta["prompts"][index][0].get<std::string>();
    options.negative_prompt = meta["prompts"][index][1].get<std::string>();
    options.steps = meta["steps"].get<int>();
    options.guidance_scale = meta["guidance"].get<float>();
    options.latents = golden.in("latents_" + std::to_string(index));
    return options;
}

TEST(Pipeline, ReproducesTheReference) {
    set_verbosity(Verbosity::quiet);
    const at::NoGradGuard no_grad;
    const Golden golden("pipeline_sd");
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    EXPECT_EQ(pipeline.downscale(), 8);
    EXPECT_EQ(pipeline.condition_channels(), 0);
    for (int i = 0; i < 2; ++i) {
        const GenerateOptions options = options_of(golden, i);
        const std::string number = "_" + std::to_string(i);
        golden.expect("prompt_ids" + number, pipeline.tokenizer().encode_batch({options.prompt}),
                      0);
        golden.expect("prompt_embeds" + number, pipeline.encode_text({options.prompt}).states);
        golden.expect("latents" + number, generate_latents(pipeline, options), 2e-4);
        golden.expect("image" + number, generate(pipeline, options), 1e-3);
    }
}

TEST(Pipeline, SurvivesSavingAsFloat16) {
    const at::NoGradGuard no_grad;
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const TemporaryFolder folder;
    pipeline.save(folder.path(), at::kFloat);
    at::manual_seed(9);
    const at::Tensor latents = at::randn({1, 4, 8, 8}), t = at::tensor({500}, at::kLong);
    const at::Tensor wanted = pipeline.predict_noise(latents, t, pipeline.encode_text({"a duck"}));
    const auto predict = [&] {
        const Pipeline again = Pipeline::load(folder.path());
        return again.predict_noise(latents, t, again.encode_text({"a duck"}));
    };
    EXPECT_LT(largest_difference(predict(), wanted), 1e-6);
    pipeline.save(folder.path(), at::kHalf);
    const double half = largest_difference(predict(), wanted);
    EXPECT_LT(half, 0.02);
    EXPECT_GT(half, 0.0);
}

TEST(Pipeline, EncodingIsTheMeanAndHasAGradient) {
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    at::manual_seed(10);
    const at::Tensor image = at::rand({1, 3, 16, 16}).requires_grad_();
    const at::Tensor latents = pipeline.encode_image(image);
    EXPECT_EQ(latents.sizes(), (std::vector<std::int64_t>{1, 4, 2, 2}));
    EXPECT_LT(largest_difference(latents.detach(), pipeline.networks().vae->encode(image).detach() *
                                                       pipeline.networks().vae->scaling_factor()),
              1e-6);
    EXPECT_GT(torch::autograd::grad({latents.sum()}, {image})[0].abs().max().item<float>(), 0);
}

TEST(Pipeline, Bfloat16WeightsStayNear) {
    const at::NoGradGuard no_grad;
    const Golden golden("pipeline_sd");
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const Pipeline half = Pipeline::load(fixture("pipeline_sd"), at::kCPU, at::kBFloat16);
    const at::Tensor latents = golden.in("latents_0");
    const TextEmbedding text = pipeline.encode_text({"a duck"});
    const at::Tensor t = at::tensor({300}, at::kLong);
    const at::Tensor wanted = pipeline.predict_noise(latents, t, text);
    const at::Tensor actual = half.predict_noise(latents, t, text);
    EXPECT_EQ(actual.scalar_type(), at::kFloat);
    EXPECT_LT((actual - wanted).norm().item<double>(), 0.03 * wanted.norm().item<double>());
}

TEST(Pipeline, GeneratingDependsOnTheSeedAloneAndNotOnTheCount) {
    set_verbosity(Verbosity::quiet);
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    GenerateOptions options;
    options.prompt = "a duck";
    options.steps = 2;
    options.width = 32;
    options.height = 16;
    options.seed = 3;
    const at::Tensor one = generate(pipeline, options);
    EXPECT_EQ(one.sizes(), (std::vector<std::int64_t>{1, 16, 32, 3}));
    EXPECT_TRUE(one.equal(generate(pipeline, options)));
    options.count = 2;
    EXPECT_LT(largest_difference(generate(pipeline, options).slice(0, 0, 1), one), 1e-5);
    options.seed = 4;
    EXPECT_GT(largest_difference(generate(pipeline, options).slice(0, 0, 1), one), 1e-3);
    options.width = 33;
    EXPECT_THROW(generate(pipeline, options), InputError);
    options.width = 32;
    options.steps = 0;
    EXPECT_THROW(generate(pipeline, options), InputError);
}

GenerateOptions from_a_image(const Pipeline& pipeline) {
    GenerateOptions options;
    options.prompt = "a duck";
    options.steps = 4;
    options.image = at::full({1, pipeline.latent_channels(), 8, 8}, 0.7f);
    return options;
}

TEST(Pipeline, WhatIsKeptOfAImageStaysAndTheRestIsDrawn) {
    set_verbosity(Verbosity::quiet);
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    GenerateOptions options = from_a_image(pipeline);
    const at::Tensor drawn = generate_latents(pipeline, options);
    options.keep = at::zeros({1, 1, 8, 8});
    EXPECT_TRUE(generate_latents(pipeline, options).equal(drawn));
    options.keep.narrow(3, 0, 4).fill_(1);
    const at::Tensor half = generate_latents(pipeline, options);
    EXPECT_TRUE(half.narrow(3, 0, 4).equal(options.image.narrow(3, 0, 4)));
    EXPECT_GT(largest_difference(half.narrow(3, 4, 4), options.image.narrow(3, 4, 4)), 0.1);
    // The drawn part depends on the kept part beside it.
    EXPECT_GT(largest_difference(half.narrow(3, 4, 4), drawn.narrow(3, 4, 4)), 1e-4);
}

TEST(Pipeline, GeneratingFromAImageWalksPartOfTheSchedule) {
    set_verbosity(Verbosity::quiet);
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    GenerateOptions options = from_a_image(pipeline);
    options.strength = 0;
    EXPECT_TRUE(generate_latents(pipeline, options).equal(options.image));
    options.strength = 0.25;
    const double little = largest_difference(generate_latents(pipeline, options), options.image);
    options.strength = 1;
    const double much = largest_difference(generate_latents(pipeline, options), options.image);
    EXPECT_GT(little, 0);
    EXPECT_LT(little, much);

    options.scheduler = "ddim";
    options.eta = 1;
    const at::Tensor noisy = generate_latents(pipeline, options);
    EXPECT_TRUE(noisy.equal(generate_latents(pipeline, options)));
    options.eta = 0;
    EXPECT_GT(largest_difference(generate_latents(pipeline, options), noisy), 1e-3);
}

TEST(Pipeline, GeneratesWithEveryScheduler) {
    set_verbosity(Verbosity::quiet);
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    GenerateOptions options;
    options.prompt = "a duck";
    options.width = 24;
    options.height = 40;
    options.steps = 4;
    std::vector<at::Tensor> drawn;
    for (const SamplerKind& kind : sampler_kinds()) {
        options.scheduler = kind.name;
        drawn.push_back(generate_latents(pipeline, options));
        EXPECT_EQ(drawn.back().sizes(), (std::vector<std::int64_t>{1, 4, 5, 3}));
        EXPECT_TRUE(at::isfinite(drawn.back()).all().item<bool>()) << kind.name;
        EXPECT_TRUE(drawn.back().equal(generate_latents(pipeline, options))) << kind.name;
        for (std::size_t i = 0; i + 1 < drawn.size(); ++i)
            EXPECT_GT(largest_difference(drawn[i], drawn.back()), 1e-4) << kind.name << " " << i;

        GenerateOptions from_image = options;
        from_image.image = at::full({1, 4, 5, 3}, 0.7f);
        from_image.strength = 0.25;
        const at::Tensor little = generate_latents(pipeline, from_image);
        EXPECT_LT(largest_difference(little, from_image.image),
                  largest_difference(drawn.back(), from_image.image))
            << kind.name;
    }
    options.scheduler = "magic";
    EXPECT_THROW(generate_latents(pipeline, options), InputError);
}

TEST(Pipeline, SaysWhatIsWrongWithAFolder) {
    const TemporaryFolder folder;
    const auto fresh = [&] {
        fs::remove_all(folder.path());
        fs::copy(fixture("pipeline_sd"), folder.path(), fs::copy_options::recursive);
    };
    const auto complaint = [&] {
        return message_of<InputError>([&] { Pipeline::load(folder.path()); });
    };
    const auto change = [&](const char* file, const char* key, const nlohmann::json& value) {
        fresh();
        auto json = nlohmann::json::parse(read_text(folder.path() / file));
        json[key] = value;
        testing::write_file(folder.path() / file, json.dump());
        const std::string message = complaint();
        EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
        return message;
    };
    const auto has = [](const std::string& message, const char* part) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    has(change("model_index.json", "unet", {"diffusers", "SD3Transformer2DModel"}),
        "SD3Transformer");
    has(change("unet/config.json", "cross_attention_dim", 64), "shape");
    has(change("unet/config.json", "layers_per_block", 2), "missing");
    has(change("scheduler/scheduler_config.json", "beta_schedule", "sigmoid"), "beta_schedule");
    has(change("scheduler/scheduler_config.json", "_class_name", "LCMScheduler"), "_class_name");
    has(change("tokenizer/tokenizer_config.json", "model_max_length", 200),
        "max_position_embeddings");
    for (const char* file :
         {"model_index.json", "unet/config.json", "vae/diffusion_pytorch_model.safetensors",
          "text_encoder/model.safetensors", "tokenizer/vocab.json",
          "scheduler/scheduler_config.json"}) {
        fresh();
        fs::remove(folder.path() / file);
        has(complaint(), fs::path(file).filename().c_str());
    }
    fs::remove_all(folder.path());
    has(complaint(), "no such folder");
}

TEST(DepthCondition, ScalesDisparityAndAveragesCells) {
    at::Tensor depth = at::zeros({1, 4, 6});
    depth[0].slice(1, 0, 2) = 1.0f;                 // near
    depth[0].slice(1, 2, 4) = 4.0f;                 // far
    depth[0].slice(1, 2, 4).slice(0, 0, 2) = 1.6f;  // disparity 0.625, halfway
    const at::Tensor condition = depth_condition(depth, 2);
    const at::Tensor wanted =
        at::tensor({1.0f, 0.6f, -1.0f, 1.0f, 0.2f, -1.0f}, at::kFloat).view({2, 3});
    EXPECT_EQ(condition.sizes(), (std::vector<std::int64_t>{1, 1, 2, 3}));
    EXPECT_LT(largest_difference(condition[0][0], wanted), 1e-5);
    // An empty view gives -1, and a half-covered cell is finite.
    EXPECT_TRUE(depth_condition(at::zeros({1, 4, 4}), 4).equal(at::full({1, 1, 1, 1}, -1.0f)));
    at::Tensor half = at::zeros({1, 2, 2});
    half[0][0].fill_(3.0f);
    EXPECT_TRUE(at::isfinite(depth_condition(half, 2)).all().item<bool>());
}

TEST(ShapeCondition, SaysWhereInSpaceTheSurfaceOfEachCellIs) {
    // The first cell of 2 x 2 pixels is half covered by a point at (.25, 0, -.5). The second is
    // empty.
    SeenShape shape{at::zeros({1, 2, 4}), at::full({1, 2, 4, 3}, 9.0f),
                    at::full({1, 2, 4, 3}, .5f)};
    shape.depth[0].slice(1, 0, 1) = 2.0f;
    shape.position[0].slice(1, 0, 1) = at::tensor({.25f, 0.0f, -.5f});
    const at::Tensor cells = shape_cells(shape, 2);
    EXPECT_EQ(cells.sizes(), (std::vector<std::int64_t>{1, 7, 1, 2}));
    EXPECT_LT(largest_difference(cells[0].slice(0, 1, 4).select(2, 0).flatten(),
                                 at::tensor({.25f, 0.0f, -.5f})),
              1e-6);
    EXPECT_EQ(cells[0][0][0][1].item<float>(), -1);

    EXPECT_FALSE(shape_condition(cells, 0).defined());
    EXPECT_TRUE(shape_condition(cells, 1).equal(cells.slice(1, 0, 1)));
    const at::Tensor all = shape_condition(cells, surface_condition_channels);
    EXPECT_EQ(all.size(1), surface_condition_channels);
    // The first wave has half a cycle per unit, so its phase is an eighth of a turn along x, none
    // along y, and a quarter of a turn back along z.
    EXPECT_TRUE(all[0].slice(0, 1, 4).select(2, 0).equal(at::full({3, 1}, .5f)));
    const at::Tensor first = all[0].slice(0, 4, 10).select(1, 0).select(1, 0);
    const float diagonal = std::sqrt(.5f);
    EXPECT_LT(largest_difference(first, at::tensor({diagonal, 0.0f, -1.0f, diagonal, 1.0f, 0.0f})),
              1e-5);
    // The normal faces all axes equally. The first of them, x, counts, so coordinates in the plane
    // are (z, y).
    const at::Tensor plane = all[0].slice(0, 4 + 6 * space_waves, 8 + 6 * space_waves);
    EXPECT_LT(
        largest_difference(plane.select(2, 0).flatten(), at::tensor({0.0f, -1.0f, 0.0f, 1.0f})),
        1e-5);
    EXPECT_TRUE(
        all[0].slice(0, 1).select(2, 1).equal(at::zeros({surface_condition_channels - 1, 1})));
}

TEST(RunningPipeline, KnowsThePromptsThatItWasToldAndNoText) {
    const Pipeline whole = Pipeline::load(fixture("pipeline_sd"));
    const RunningPipeline running = RunningPipeline::load(
        fixture("pipeline_sd"), at::kCPU, at::kFloat, {}, {{"a duck", "a golden duck"}});
    const at::Tensor duck = whole.encode_text({"a duck"}).states;
    EXPECT_TRUE(running.encode_text({"a duck"}).states.equal(duck));
    EXPECT_TRUE(running.encode_no_text().states.equal(whole.encode_no_text().states));
    const TextEmbedding both = running.encode_text({"a golden duck", "a duck"});
    EXPECT_EQ(both.rows(), 2);
    EXPECT_TRUE(both.row(1).states.equal(duck));
    EXPECT_FALSE(both.row(0).states.equal(duck));
    EXPECT_ANY_THROW(running.encode_text({"a cat"}));
}

TEST(RunningPipeline, IsTheSameButForWhatItDoesNotNeed) {
    const Pipeline whole = Pipeline::load(fixture("pipeline_sd"));
    const RunningPipeline running = RunningPipeline::load(
        fixture("pipeline_sd"), at::kCPU, at::kFloat, {}, {{"a duck"}, /*decoder=*/false});
    const at::NoGradGuard no_grad;
    at::manual_seed(0);
    const at::Tensor image = at::rand({1, 3, 64, 64}) * 2 - 1;
    const at::Tensor latents = whole.encode_image(image);
    EXPECT_LT(largest_difference(running.encode_image(image), latents), 1e-5);
    const TextEmbedding text = whole.encode_text({"a duck"});
    EXPECT_TRUE(running.encode_text({"a duck"}).states.equal(text.states));
    const at::Tensor timestep = at::full({1}, 400, at::kLong);
    EXPECT_LT(largest_difference(running.predict_noise(latents, timestep, text),
                                 whole.predict_noise(latents, timestep, text)),
              1e-5);
    EXPECT_ANY_THROW(running.decode_image(latents));
    EXPECT_LT(running.networks().vae->parameters().size(),
              whole.networks().vae->parameters().size());
}

}  // namespace
}  // namespace item3d
