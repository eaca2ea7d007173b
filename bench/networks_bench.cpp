// Benchmark of the networks in one iteration of an edit, at the embedded prior's size: the U-Net,
// the U-Net with a gradient with respect to the text embedding (which --adjust learned needs), and
// the autoencoder. The argument is the number of batch rows. The weights are random, which does not
// change the time.
#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/tensors/tensor.h"

#include <ATen/autocast_mode.h>
#include <benchmark/benchmark.h>
#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

enum class Precision { float32, bfloat16, autocast };

UNet2DCondition make_unet(Precision precision) {
    at::manual_seed(1);
    const std::vector<std::string> down(3, "CrossAttnDownBlock2D"), up(3, "CrossAttnUpBlock2D");
    UNet2DCondition unet(UNet2DConditionConfig::from_json({{"in_channels", 5},
                                                           {"block_out_channels", {48, 96, 144}},
                                                           {"down_block_types", down},
                                                           {"up_block_types", up},
                                                           {"layers_per_block", 1},
                                                           {"attention_head_dim", {2, 4, 6}},
                                                           {"cross_attention_dim", 192},
                                                           {"norm_num_groups", 16}}));
    for (at::Tensor& parameter : unet->parameters()) {
        parameter.set_requires_grad(false);
        if (precision == Precision::bfloat16) parameter.set_data(parameter.to(at::kBFloat16));
        if (parameter.dim() == 4)
            parameter.set_data(parameter.contiguous(at::MemoryFormat::ChannelsLast));
    }
    return unet;
}

void use_autocast(bool enabled) {
    at::autocast::set_autocast_dtype(at::kCPU, at::kBFloat16);
    at::autocast::set_autocast_enabled(at::kCPU, enabled);
    at::autocast::clear_cache();
}

void predict(benchmark::State& state, Precision precision, bool gradient) {
    UNet2DCondition unet = make_unet(precision);
    const auto rows = state.range(0);
    const at::Tensor sample =
        at::randn({rows, 5, 16, 16}).contiguous(at::MemoryFormat::ChannelsLast);
    const at::Tensor text = at::randn({rows, 20, 192}).set_requires_grad(gradient);
    const at::Tensor timesteps = at::full({rows}, 500, at::kLong);
    const at::AutoGradMode mode(gradient);
    if (precision == Precision::autocast) use_autocast(true);
    for (auto _ : state) {
        const at::Tensor output = unet(sample, timesteps, text);
        if (gradient)
            benchmark::DoNotOptimize(
                torch::autograd::grad({output.to(at::kFloat).square().mean()}, {text}));
        benchmark::DoNotOptimize(output);
    }
    use_autocast(false);
}

void encode(benchmark::State& state, at::ScalarType dtype) {
    AutoencoderTinyConfig config;
    config.encoder_block_out_channels = config.decoder_block_out_channels = {32, 32, 32};
    config.num_encoder_blocks = {1, 2, 3};
    config.num_decoder_blocks = {3, 2, 1};
    AutoencoderTiny vae(config);
    for (at::Tensor& parameter : vae.parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(parameter.to(dtype));
    }
    const at::Tensor images = at::rand({state.range(0), 3, 64, 64})
                                  .contiguous(at::MemoryFormat::ChannelsLast)
                                  .set_requires_grad(true);
    for (auto _ : state)
        benchmark::DoNotOptimize(
            torch::autograd::grad({vae.encode(images).to(at::kFloat).square().mean()}, {images}));
}

BENCHMARK_CAPTURE(predict, float32, Precision::float32, false)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(predict, bfloat16, Precision::bfloat16, false)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(predict, autocast, Precision::autocast, false)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(predict, float32_text_gradient, Precision::float32, true)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(predict, bfloat16_text_gradient, Precision::bfloat16, true)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode, float32_and_gradient, at::kFloat)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode, bfloat16_and_gradient, at::kBFloat16)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace item3d
