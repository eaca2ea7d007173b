// Layers of diffusers' U-Net and AutoencoderKL. Registered names are diffusers' own, so that
// weights load by name. Feature maps are [N, C, H, W], tokens [N, S, C].
#pragma once

#include "item3d/networks/diffusion/attention_maps.h"
#include "item3d/networks/layers/conv3x3.h"
#include "item3d/networks/layers/packable_linear.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/container/modulelist.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/normalization.h>

#include <vector>

namespace item3d {

/// Options of a 3x3 convolution that keeps the size.
inline torch::nn::Conv2dOptions conv3x3(int in_channels, int out_channels) {
    return torch::nn::Conv2dOptions(in_channels, out_channels, 3).padding(1);
}

/// Group norm, SiLU and 3x3 convolution, twice, with a shortcut (diffusers' ResnetBlock2D).
class ResnetBlockImpl : public torch::nn::Module {
  public:
    struct Options {
        int in_channels;
        int out_channels;
        int time_channels = 0;  ///< width of the time embedding; 0 if the block takes none
        int groups = 32;
        double epsilon = 1e-5;
        double output_scale = 1.0;  ///< divisor of the sum with the shortcut
    };
    explicit ResnetBlockImpl(const Options& options);
    /// time is [N, time_channels], after SiLU. It is ignored if the block takes none.
    at::Tensor forward(const at::Tensor& x, const at::Tensor& time = {});

  private:
    Options options_;
    torch::nn::GroupNorm norm1_{nullptr}, norm2_{nullptr};
    Conv3x3 conv1_{nullptr}, conv2_{nullptr};
    torch::nn::Conv2d conv_shortcut_{nullptr};
    PackableLinear time_emb_proj_{nullptr};
};
TORCH_MODULE(ResnetBlock);

/// Self-attention, or cross-attention when given a context (diffusers' Attention).
class AttentionLayerImpl : public torch::nn::Module {
  public:
    /// bias: true if the query, key and value projections have a bias, as in the autoencoder and
    /// not in the U-Net.
    AttentionLayerImpl(int channels, int context_channels, int heads, bool bias = false);
    /// maps, unless null, accumulates the attention weights.
    at::Tensor forward(const at::Tensor& x, const at::Tensor& context = {},
                       AttentionMaps* maps = nullptr);

  private:
    int heads_;
    PackableLinear to_q_{nullptr}, to_k_{nullptr}, to_v_{nullptr};
    torch::nn::ModuleList to_out_;
};
TORCH_MODULE(AttentionLayer);

/// Self-attention, cross-attention, gated-GELU feed-forward (diffusers' BasicTransformerBlock).
class TransformerBlockImpl : public torch::nn::Module {
  public:
    TransformerBlockImpl(int channels, int context_channels, int heads);
    at::Tensor forward(at::Tensor x, const at::Tensor& context, AttentionMaps* maps = nullptr);

  private:
    torch::nn::LayerNorm norm1_{nullptr}, norm2_{nullptr}, norm3_{nullptr};
    AttentionLayer attn1_{nullptr}, attn2_{nullptr};
    PackableLinear feed_in_{nullptr}, feed_out_{nullptr};
};
TORCH_MODULE(TransformerBlock);

/// Transformer blocks over the pixels of a feature map (diffusers' Transformer2DModel).
class SpatialTransformerImpl : public torch::nn::Module {
  public:
    struct Options {
        int channels;
        int context_channels;
        int heads;
        int layers = 1;
        int groups = 32;
        bool linear_projection = false;  ///< proj_in and proj_out are linear, not 1x1 convolutions
    };
    explicit SpatialTransformerImpl(const Options& options);
    /// maps, unless null, accumulates the blocks' cross-attention.
    at::Tensor forward(const at::Tensor& x, const at::Tensor& context,
                       AttentionMaps* maps = nullptr);

  private:
    Options options_;
    torch::nn::GroupNorm norm_{nullptr};
    torch::nn::Conv2d conv_in_{nullptr}, conv_out_{nullptr};
    PackableLinear linear_in_{nullptr}, linear_out_{nullptr};
    std::vector<TransformerBlock> blocks_;
};
TORCH_MODULE(SpatialTransformer);

/// 3x3 convolution of stride 2. If `padding` is 0, the layer instead pads one column at the right
/// and one row at the bottom.
class DownsampleImpl : public torch::nn::Module {
  public:
    DownsampleImpl(int channels, int padding);
    at::Tensor forward(const at::Tensor& x);

  private:
    int padding_;
    torch::nn::Conv2d conv_{nullptr};
};
TORCH_MODULE(Downsample);

/// Nearest-neighbour enlargement, followed by a 3x3 convolution.
class UpsampleImpl : public torch::nn::Module {
  public:
    explicit UpsampleImpl(int channels);
    /// Enlarges to height x width pixels.
    at::Tensor forward(const at::Tensor& x, std::int64_t height, std::int64_t width);

  private:
    Conv3x3 conv_{nullptr};
};
TORCH_MODULE(Upsample);

/// Appends `layer` to the registered list and to the typed one.
template <typename Layer>
void append(torch::nn::ModuleList& list, std::vector<Layer>& typed, const Layer& layer) {
    list->push_back(layer);
    typed.push_back(layer);
}

}  // namespace item3d
