#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/generate.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

TEST(PipelineSdxl, ReproducesTheReference) {
    set_verbosity(Verbosity::quiet);
    const at::NoGradGuard no_grad;
    const Golden golden("pipeline_sdxl");
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sdxl"));
    const auto meta = nlohmann::json::parse(read_text(fixture("pipeline_sdxl") / "meta.json"));
    EXPECT_TRUE(pipeline.is_sdxl());
    for (int i = 0; i < 2; ++i) {
        const std::string number = "_" + std::to_string(i);
        GenerateOptions options;
        options.prompt = meta["prompts"][i][0].get<std::string>();
        // The second case has no negative prompt. This stands for zeros, not for the empty prompt.
        if (i == 0) options.negative_prompt = meta["prompts"][i][1].get<std::string>();
        options.steps = meta["steps"].get<int>();
        options.guidance_scale = meta["guidance"].get<float>();
        options.latents = golden.in("latents" + number);
        const TextEmbedding text = pipeline.encode_text({options.prompt});
        golden.expect("pooled" + number, text.pooled);
        if (i == 0) golden.expect("prompt_embeds_0", text.states);
        const TextEmbedding without =
            i == 0 ? pipeline.encode_text({*options.negative_prompt}) : pipeline.encode_no_text();
        golden.expect("negative_pooled" + number, without.pooled);
        golden.expect("latents" + number, generate_latents(pipeline, options), 2e-4);
    }
    EXPECT_EQ(pipeline.encode_no_text().states.abs().max().item<float>(), 0.0f);
    EXPECT_GT(pipeline.encode_text({""}).states.abs().max().item<float>(), 0.0f);
}

TEST(PipelineSdxl, IsToldTheSizeOfTheImage) {
    const at::NoGradGuard no_grad;
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sdxl"));
    const TextEmbedding text = pipeline.encode_text({"a duck"});
    // For constant latents, only the image's size matters, except at the borders.
    const auto center = [&](std::int64_t cells) {
        const at::Tensor flat = at::zeros({1, 4, cells, cells});
        return pipeline.predict(flat, at::tensor({500}, at::kLong), text)
            .slice(2, cells / 2, cells / 2 + 1)
            .slice(3, cells / 2, cells / 2 + 1);
    };
    EXPECT_GT(largest_difference(center(32), center(48)), 1e-4);
}

TEST(PipelineSdxl, SurvivesSaving) {
    const at::NoGradGuard no_grad;
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sdxl"));
    const TemporaryFolder folder;
    pipeline.save(folder.path(), at::kFloat);
    const Pipeline again = Pipeline::load(folder.path());
    at::manual_seed(11);
    const at::Tensor latents = at::randn({2, 4, 4, 4}), t = at::tensor({500, 20}, at::kLong);
    const auto predict = [&](const Pipeline& model) {
        return model.predict_noise(latents, t, model.encode_text({"a duck", ""}));
    };
    EXPECT_LT(largest_difference(predict(again), predict(pipeline)), 1e-6);
    EXPECT_TRUE(again.encode_no_text().states.eq(0).all().item<bool>());
    EXPECT_EQ(again.schedule().config().sampler_name(), "euler");
}

TEST(PipelineSdxl, SaysWhatIsWrongWithAFolder) {
    const TemporaryFolder folder;
    const auto complaint = [&](const char* file, const char* key, const nlohmann::json& value) {
        fs::remove_all(folder.path());
        fs::copy(fixture("pipeline_sdxl"), folder.path(), fs::copy_options::recursive);
        auto json = nlohmann::json::parse(read_text(folder.path() / file));
        json[key] = value;
        testing::write_file(folder.path() / file, json.dump());
        return message_of<InputError>([&] { Pipeline::load(folder.path()); });
    };
    const auto has = [](const std::string& message, const char* part) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    // The first folder is one of the refiner, the second lacks its second encoder.
    has(complaint("model_index.json", "text_encoder", {nullptr, nullptr}), "text_encoder");
    has(complaint("model_index.json", "text_encoder_2", {nullptr, nullptr}), "cross_attention_dim");
    has(complaint("model_index.json", "text_encoder_2", {"transformers", "T5EncoderModel"}), "T5");
    has(complaint("model_index.json", "tokenizer_2", {"transformers", "T5Tokenizer"}), "T5");
    has(complaint("model_index.json", "force_zeros_for_empty_prompt", "yes"), "force_zeros");
    has(complaint("tokenizer_2/tokenizer_config.json", "model_max_length", 64), "tokenizers");
    has(complaint("text_encoder_2/config.json", "architectures", {"CLIPTextModel"}),
        "text_projection");
}

}  // namespace
}  // namespace item3d
