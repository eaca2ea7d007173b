#include "item3d/networks/diffusion/controlnet.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/pipeline_extras.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

TEST(ControlNet, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden("controlnet_depth");
    ControlNet network = load_controlnet(fixture("controlnet_depth"));
    const auto residuals = [&](double scale) {
        return network(golden.in("sample"), golden.in("timestep"),
                       golden.in("encoder_hidden_states"), golden.in("controlnet_cond"), scale);
    };
    const UNetResiduals whole = residuals(1);
    ASSERT_EQ(whole.down.size(), 6u);
    for (std::size_t i = 0; i < whole.down.size(); ++i)
        golden.expect("down_" + std::to_string(i), whole.down[i], 5e-5);
    golden.expect("mid", whole.mid, 5e-5);
    EXPECT_LT(largest_difference(residuals(0.5).mid, whole.mid / 2), 1e-6);
}

TEST(ControlNet, ChangesWhatThePipelinePredictsWhereItHasDepth) {
    const at::NoGradGuard no_grad;
    Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    EXPECT_FALSE(takes_shape(pipeline));
    at::manual_seed(5);
    const at::Tensor latents = at::randn({2, 4, 4, 3}), t = at::tensor({300, 300}, at::kLong);
    const TextEmbedding text = pipeline.encode_text({"a duck"});
    const at::Tensor depth = at::rand({2, 64, 48}) + 1;  // twice the images' resolution
    EXPECT_FALSE(condition_of_shape(pipeline, {depth, {}, {}}, latents).defined());
    const at::Tensor plain = pipeline.predict(latents, t, text);

    PipelineExtras extras;
    extras.controlnet = fixture("controlnet_depth").string();
    extras.controlnet_scale = 0.7f;
    pipeline.add(extras);
    ASSERT_TRUE(takes_shape(pipeline));
    const at::Tensor image = condition_of_shape(pipeline, {depth, {}, {}}, latents);
    EXPECT_EQ(image.sizes(), (std::vector<std::int64_t>{2, 3, 32, 24}));
    EXPECT_TRUE(pipeline.predict(latents, t, text).equal(plain));
    const at::Tensor context = text.expand(2).states;
    const UNetResiduals residuals =
        ControlNet(pipeline.networks().controlnet)(latents, t, context, image, 0.7f);
    const at::Tensor wanted =
        UNet2DCondition(pipeline.networks().unet)(latents, t, context, AddedCondition{}, residuals);
    const at::Tensor predicted = pipeline.predict(latents, t, text, image);
    EXPECT_LT(largest_difference(predicted, wanted), 1e-5);
    EXPECT_GT(largest_difference(predicted, plain), 1e-3);
    EXPECT_LT(
        largest_difference(pipeline.predict(latents, t, text, image.slice(0, 0, 1)).slice(0, 0, 1),
                           predicted.slice(0, 0, 1)),
        1e-5);  // all rows may share one condition
}

TEST(ControlNet, DepthImageIsDisparityOnBlack) {
    at::Tensor depth = at::zeros({1, 4, 6});
    depth[0].slice(1, 0, 2) = 1.0f;  // near
    depth[0].slice(1, 2, 4) = 4.0f;  // far
    const at::Tensor image = depth_image(depth, 2, 3);
    EXPECT_EQ(image.sizes(), (std::vector<std::int64_t>{1, 3, 2, 3}));
    const at::Tensor wanted = at::tensor({1.0f, 0.2f, 0.0f});
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_LT(largest_difference(image[0][channel][1], wanted), 1e-6);
    EXPECT_TRUE(depth_image(at::zeros({1, 4, 4}), 4, 4).eq(0).all().item<bool>());
}

TEST(PipelineExtras, ReplaceTheAutoencoder) {
    const at::NoGradGuard no_grad;
    Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"), at::kCPU, at::kBFloat16);
    PipelineExtras extras;
    extras.vae = fixture("vae_tiny").string();
    pipeline.add(extras);
    EXPECT_NE(dynamic_cast<AutoencoderTiny*>(pipeline.networks().vae.get()), nullptr);
    EXPECT_EQ(pipeline.networks().vae->parameters()[0].scalar_type(), at::kBFloat16);
    EXPECT_EQ(pipeline.encode_image(at::zeros({1, 3, 16, 24})).sizes(),
              (std::vector<std::int64_t>{1, 4, 2, 3}));
}

TEST(PipelineExtras, SayWhatDoesNotFit) {
    const TemporaryFolder folder;
    const auto complaint = [&](const PipelineExtras& extras) {
        Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
        return message_of<InputError>([&] { pipeline.add(extras); });
    };
    const auto has = [](const std::string& message, const std::string& part) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
    };
    PipelineExtras extras;
    extras.lora = {(fixture("lora") / "kohya.safetensors:much").string()};
    has(complaint(extras), "'much' is not a number");
    extras.lora = {"/nowhere.safetensors"};
    has(complaint(extras), "/nowhere.safetensors");
    extras = {};
    extras.embedding = {"/nowhere.safetensors"};
    has(complaint(extras), "/nowhere.safetensors");

    const auto controlnet = folder.path() / "controlnet";
    fs::copy(fixture("controlnet_depth"), controlnet);
    extras = {};
    extras.controlnet = controlnet.string();
    const auto config = nlohmann::json::parse(read_text(controlnet / "config.json"));
    const auto change = [&](const char* key, const nlohmann::json& value) {
        nlohmann::json changed = config;
        changed[key] = value;
        testing::write_file(controlnet / "config.json", changed.dump());
        has(complaint(extras), controlnet.string());
        return complaint(extras);
    };
    has(change("cross_attention_dim", 64), "shape");
    has(change("_class_name", "UNet2DConditionModel"), "ControlNetModel");
    has(change("controlnet_conditioning_channel_order", "grey"), "rgb or bgr");
    has(change("global_pool_conditions", true), "global_pool_conditions");
    has(change("conditioning_embedding_out_channels", nlohmann::json::array()), "at least one");
    testing::write_file(controlnet / "config.json", config.dump());
    extras.controlnet_scale = -1;
    has(complaint(extras), "--controlnet-scale");
    Pipeline with_depth = Pipeline::load(fixture("pipeline_sd"));
    with_depth.networks().unet = load_unet(fixture("unet_depth"));
    extras.controlnet_scale = 1;
    has(message_of<InputError>([&] { with_depth.add(extras); }), "additional input channels");

    extras = {};
    extras.vae = (folder.path() / "vae").string();
    has(complaint(extras), "vae");
    fs::copy(fixture("vae_tiny"), extras.vae);
    Pipeline other = Pipeline::load(fixture("pipeline_sd"));
    AutoencoderTinyConfig flat;
    flat.encoder_block_out_channels = flat.decoder_block_out_channels = {8, 8};
    flat.num_encoder_blocks = flat.num_decoder_blocks = {1, 1};
    other.networks().vae = std::make_shared<AutoencoderTiny>(flat);
    has(message_of<InputError>([&] { other.add(extras); }), "pixels");
}

}  // namespace
}  // namespace item3d
