#include "item3d/networks/diffusion/lora.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/lora_names.h"
#include "tests/support/networks.h"

#include <cmath>

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

/// Returns a U-Net of Stable Diffusion's structure, with few channels.
UNet2DCondition lora_unet() {
    at::manual_seed(3);
    UNet2DCondition unet(UNet2DConditionConfig::from_json({{"block_out_channels", {8, 8, 16, 16}},
                                                           {"attention_head_dim", 2},
                                                           {"cross_attention_dim", 12},
                                                           {"norm_num_groups", 4}}));
    for (at::Tensor& parameter : unet->parameters())
        parameter.set_requires_grad(false);
    return unet;
}

const std::string query = "down_blocks.0.attentions.0.transformer_blocks.0.attn1.to_q";

at::Tensor weight_of(const UNet2DCondition& unet, const std::string& module) {
    return unet->named_parameters()[module + ".weight"];
}

/// Writes one LoRA file and fuses it.
void fuse(const UNet2DCondition& unet, const NamedTensors& tensors, double scale = 1,
          const std::map<std::string, std::string>& metadata = {}) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "lora.safetensors";
    save_safetensors(path, tensors, metadata);
    LoraTargets targets;
    targets.unet = unet;
    fuse_loras({{path, scale}}, targets);
}

TEST(Lora, ReproducesTheReferenceInEverySpelling) {
    const at::NoGradGuard no_grad;
    const Golden golden("lora");
    for (const char* file : {"peft", "pytorch_lora_weights", "kohya"}) {
        for (const char* scale : {"0.6", "1.0"}) {
            LoraTargets targets;
            targets.text_encoder = load_clip_text(fixture("clip_text_sd15"));
            fuse_loras({{fixture("lora") / (std::string(file) + ".safetensors"), std::atof(scale)}},
                       targets);
            golden.expect(std::string("kohya.last_hidden_state_") + scale,
                          targets.text_encoder(golden.in("input_ids")).last_hidden_state, 5e-5);
        }
    }
}

TEST(Lora, AFusedConvolutionActsAsThroughTheRank) {
    const UNet2DCondition unet = lora_unet();
    const std::string module = "down_blocks.0.resnets.0.conv1";
    const at::Tensor before = weight_of(unet, module).clone();
    const at::Tensor down = at::randn({2, 8, 3, 3}), up = at::randn({8, 2, 1, 1});
    fuse(unet,
         {{"lora_unet_input_blocks_1_0_in_layers_2.lora_down.weight", down},
          {"lora_unet_input_blocks_1_0_in_layers_2.lora_up.weight", up},
          {"lora_unet_input_blocks_1_0_in_layers_2.alpha", at::scalar_tensor(3.0f)}},
         0.5);
    const at::Tensor x = at::randn({1, 8, 5, 6});
    const at::Tensor change = at::conv2d(x, weight_of(unet, module) - before, {}, 1, 1);
    const at::Tensor wanted = 0.5 * 3.0 / 2.0 * at::conv2d(at::conv2d(x, down, {}, 1, 1), up);
    EXPECT_LT(largest_difference(change, wanted), 1e-4);
}

TEST(Lora, KnowsTheOriginalNamesOfStableDiffusion) {
    const LoraSpellings names = unet_spellings(*lora_unet());
    const std::vector<std::pair<const char*, const char*>> known = {
        {"input_blocks_0_0", "conv_in"},
        {"time_embed_2", "time_embedding.linear_2"},
        {"input_blocks_1_1_proj_in", "down_blocks.0.attentions.0.proj_in"},
        {"input_blocks_2_0_emb_layers_1", "down_blocks.0.resnets.1.time_emb_proj"},
        {"input_blocks_3_0_op", "down_blocks.0.downsamplers.0.conv"},
        {"input_blocks_4_1_transformer_blocks_0_attn2_to_out_0",
         "down_blocks.1.attentions.0.transformer_blocks.0.attn2.to_out.0"},
        {"input_blocks_7_0_skip_connection", "down_blocks.2.resnets.0.conv_shortcut"},
        {"input_blocks_11_0_out_layers_3", "down_blocks.3.resnets.1.conv2"},
        {"middle_block_0_in_layers_2", "mid_block.resnets.0.conv1"},
        {"middle_block_1_proj_out", "mid_block.attentions.0.proj_out"},
        {"middle_block_2_out_layers_3", "mid_block.resnets.1.conv2"},
        {"output_blocks_2_1_conv", "up_blocks.0.upsamplers.0.conv"},
        {"output_blocks_3_1_transformer_blocks_0_ff_net_0_proj",
         "up_blocks.1.attentions.0.transformer_blocks.0.ff.net.0.proj"},
        {"output_blocks_5_2_conv", "up_blocks.1.upsamplers.0.conv"},
        {"output_blocks_11_1_proj_in", "up_blocks.3.attentions.2.proj_in"},
        {"out_2", "conv_out"},
        {"mid_block.attentions.0.transformer_blocks.0.attn1.processor.to_out",
         "mid_block.attentions.0.transformer_blocks.0.attn1.to_out.0"},
        {"up_blocks_3_attentions_2_proj_in", "up_blocks.3.attentions.2.proj_in"},
    };
    for (const auto& [name, module] : known) {
        ASSERT_EQ(names.count(name), 1u) << name;
        EXPECT_EQ(names.at(name), module);
    }
    EXPECT_EQ(names.count("conv_norm_out"), 0u);  // its weight is a vector, not a matrix
}

TEST(Lora, SeveralFilesAddUpInFloat32BeforeTheCast) {
    UNet2DCondition unet = lora_unet();
    unet->to(at::kBFloat16);
    const at::Tensor before = weight_of(unet, query).clone();
    // One file alone is too small to change the weights in bfloat16.
    const at::Tensor down = at::ones({1, 8}), up = before.slice(1, 0, 1).to(at::kFloat);
    const TemporaryFolder folder;
    const auto path = folder.path() / "small.safetensors";
    save_safetensors(path, {{"unet." + query + ".lora_A.weight", down},
                            {"unet." + query + ".lora_B.weight", up}});
    LoraTargets targets;
    targets.unet = unet;
    const LoraFile part{path, 1.0 / 600};
    fuse_loras({part, part, part, part, part, part}, targets);
    const at::Tensor wanted = (before.to(at::kFloat) + at::mm(up, down) / 100).to(at::kBFloat16);
    EXPECT_EQ(weight_of(unet, query).scalar_type(), at::kBFloat16);
    EXPECT_LT(largest_difference(weight_of(unet, query).select(1, 0), wanted.select(1, 0)), 1e-9);
    EXPECT_FALSE(weight_of(unet, query).select(1, 0).equal(before.select(1, 0)));
}

TEST(Lora, TakesAlphaFromTheRecordOfDiffusers) {
    const NamedTensors tensors = {{"unet." + query + ".lora_A.weight", at::ones({4, 8})},
                                  {"unet." + query + ".lora_B.weight", at::ones({8, 4})}};
    const auto change = [&](const std::string& record) {
        const UNet2DCondition unet = lora_unet();
        const at::Tensor before = weight_of(unet, query).clone();
        fuse(unet, tensors, 1, {{"lora_adapter_metadata", record}});
        return (weight_of(unet, query) - before).mean().item<double>();
    };
    EXPECT_NEAR(change("{}"), 4, 1e-5);
    EXPECT_NEAR(change(R"({"unet.r": 4, "unet.lora_alpha": 8})"), 8, 1e-5);
    EXPECT_NEAR(change(R"({"unet.lora_alpha": 8, "unet.use_rslora": true})"), 16, 1e-5);
    EXPECT_NEAR(change(R"({"unet.lora_alpha": 8, "unet.alpha_pattern": {"to_q": 2}})"), 2, 1e-5);
    EXPECT_THROW(change(R"({"unet.use_dora": true})"), InputError);
    EXPECT_THROW(change("no JSON"), InputError);
}

/// Returns the mean change of the query's weights by a LoRA file.
double mean_change(const std::filesystem::path& file) {
    LoraTargets targets;
    targets.unet = lora_unet();
    const at::Tensor before = weight_of(targets.unet, query).clone();
    fuse_loras({{file, 1}}, targets);
    return (weight_of(targets.unet, query) - before).mean().item<double>();
}

TEST(Lora, TakesAlphaFromTheConfigurationBesideIt) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "adapter_model.safetensors";
    const std::string base = "base_model.model." + query;
    save_safetensors(path, {{base + ".lora_A.weight", at::ones({4, 8})},
                            {base + ".lora_B.weight", at::ones({8, 4})}});
    EXPECT_NEAR(mean_change(path), 4, 1e-5);
    const auto config = folder.path() / "adapter_config.json";
    testing::write_file(config, R"({"peft_type": "LORA", "r": 4, "lora_alpha": 2})");
    EXPECT_NEAR(mean_change(path), 2, 1e-5);
    testing::write_file(config, R"({"peft_type": "LORA", "lora_alpha": 2, "use_rslora": true})");
    EXPECT_NEAR(mean_change(path), 4, 1e-5);
    testing::write_file(config, R"({"peft_type": "LOHA", "lora_alpha": 2})");
    EXPECT_THROW(mean_change(path), InputError);
}

TEST(Lora, KnowsOriginalNamesWithDotsAndLeavesEmbeddingsOut) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "lora.safetensors";
    const std::string module = "input_blocks.1.1.transformer_blocks.0.attn1.to_q";
    for (const char* network : {"unet.", "diffusion_model.", "model.diffusion_model."}) {
        save_safetensors(path, {{network + module + ".lora_down.weight", at::ones({4, 8})},
                                {network + module + ".lora_up.weight", at::ones({8, 4})},
                                {"bundle_emb.word.clip_l", at::ones({2, 32})}});
        ::testing::internal::CaptureStderr();
        EXPECT_NEAR(mean_change(path), 4, 1e-5) << network;
        const std::string said = ::testing::internal::GetCapturedStderr();
        EXPECT_NE(said.find("embedding 'word' is ignored"), std::string::npos) << said;
    }
}

TEST(Lora, NamesFileAndTensorOfWhatItRefuses) {
    const at::Tensor down = at::ones({2, 8}), up = at::ones({8, 2});
    const std::string base = "lora_unet_conv_nowhere", q = "unet." + query;
    struct Broken {
        NamedTensors tensors;
        const char* tensor;
        const char* problem;
    };
    const std::vector<Broken> cases = {
        {{{base + ".lora_down.weight", down}}, "lora_unet_conv_nowhere", "matches no layer"},
        {{{"lora_te_text_model_x.lora_down.weight", down}}, "lora_te_", "missing in this model"},
        {{{"lora_te2_text_model_x.lora_down.weight", down}}, "lora_te2_", "text_encoder_2"},
        {{{"model.diffusion_model.weight", down}}, "diffusion_model", "not a LoRA tensor"},
        {{{q + ".lora_A.weight", down}}, "to_q.lora_A", "'up'"},
        {{{q + ".lora_B.weight", up}}, "to_q.lora_B", "'down'"},
        {{{q + ".alpha", at::ones({})}}, "to_q.alpha", "has no matching tensor"},
        {{{q + ".lora_A.weight", down}, {q + ".lora_B.weight", at::ones({8, 3})}},
         "to_q.lora_B",
         "rank"},
        {{{q + ".lora_A.weight", at::ones({2, 9})}, {q + ".lora_B.weight", up}},
         "to_q.lora_A",
         "[8, 8]"},
        {{{q + ".lora_A.weight", down}, {q + ".lora_B.weight", at::ones({7, 2})}},
         "to_q.lora_B",
         "[8, 8]"},
        {{{q + ".lora_A.weight", at::ones({2})}, {q + ".lora_B.weight", up}},
         "to_q.lora_A",
         "matrix"},
        {{{q + ".lora_A.weight", at::ones({2, 8}, at::kLong)}, {q + ".lora_B.weight", up}},
         "to_q.lora_A",
         "floating"},
        {{{q + ".lora_A.weight", down},
          {q + ".lora_B.weight", up},
          {q + ".alpha", at::full({1}, NAN)}},
         "to_q.alpha",
         "finite"},
        {{{q + ".lora_A.weight", down}, {query + ".lora_down.weight", down}},
         "to_q.lora_",
         "same layer"},
        {{{base + ".hada_w1_a", down}}, "hada_w1_a", "LoHa"},
        {{{base + ".lokr_w1", down}}, "lokr_w1", "LoKr"},
        {{{q + ".dora_scale", down}}, "dora_scale", "DoRA"},
    };
    const TemporaryFolder folder;
    const auto path = folder.path() / "lora.safetensors";
    LoraTargets targets;
    targets.unet = lora_unet();
    const at::Tensor before = weight_of(targets.unet, query).clone();
    for (const Broken& broken : cases) {
        save_safetensors(path, broken.tensors);
        const std::string message = message_of<InputError>([&] {
            fuse_loras({{path, 1}}, targets);
        });
        for (const std::string& part :
             {path.string(), std::string(broken.tensor), std::string(broken.problem)})
            EXPECT_NE(message.find(part), std::string::npos) << message << "\nwanted " << part;
    }
    save_safetensors(path, {});
    EXPECT_THROW(fuse_loras({{path, 1}}, targets), InputError);
    EXPECT_THROW(fuse_loras({{folder.path() / "none.safetensors", 1}}, targets), InputError);
    EXPECT_TRUE(weight_of(targets.unet, query).equal(before));
}

}  // namespace
}  // namespace item3d
