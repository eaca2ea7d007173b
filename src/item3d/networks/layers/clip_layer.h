// Transformer layer of CLIP's text and image encoders.
#pragma once

#include "item3d/networks/layers/packable_linear.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/normalization.h>

#include <string>

namespace item3d {

struct ClipLayerOptions {
    int width = 512;
    int intermediate = 2048;  ///< width of the MLP
    int heads = 8;
    std::string activation = "quick_gelu";  ///< or "gelu"
    double epsilon = 1e-5;                  ///< epsilon of the layer norms
};

/// Pre-norm self-attention and MLP (Radford et al. 2021). Its parameters have the names of
/// transformers' CLIPEncoderLayer.
class ClipLayerImpl : public torch::nn::Module {
  public:
    explicit ClipLayerImpl(const ClipLayerOptions& options);
    /// x is [N, S, width]. mask is empty, or additive and broadcastable to [N, heads, S, S].
    at::Tensor forward(const at::Tensor& x, const at::Tensor& mask = {});
    /// Returns forward() of the first token only, [N, 1, width], for a last layer whose other
    /// tokens are unused.
    at::Tensor forward_first(const at::Tensor& x);

  private:
    /// Computes the layer for the tokens x, the first ones of the sequence. `normed`: all tokens of
    /// the sequence after the first layer norm.
    at::Tensor attend(const at::Tensor& x, const at::Tensor& normed, const at::Tensor& mask);

    int heads_;
    LinearActivation activation_;
    torch::nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
    PackableLinear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
    PackableLinear feed_in_{nullptr}, feed_out_{nullptr};
};
TORCH_MODULE(ClipLayer);

}  // namespace item3d
