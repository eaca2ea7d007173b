// The transformer layer that both halves of CLIP are stacks of.
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
    double epsilon = 1e-5;                  ///< of the layer norms
};

/// Pre-norm self-attention and MLP (Radford et al. 2021), names as in transformers'
/// CLIPEncoderLayer.
class ClipLayerImpl : public torch::nn::Module {
  public:
    explicit ClipLayerImpl(const ClipLayerOptions& options);
    /// x [N, S, width]; mask: empty, or additive and broadcastable to [N, heads, S, S].
    at::Tensor forward(const at::Tensor& x, const at::Tensor& mask = {});
    /// What forward() gives for the first token, [N, 1, width], for the last layer of a network
    /// whose other tokens nobody looks at.
    at::Tensor forward_first(const at::Tensor& x);

  private:
    /// `x`: those of the tokens `normed` that are wanted.
    at::Tensor attend(const at::Tensor& x, const at::Tensor& normed, const at::Tensor& mask);

    int heads_;
    LinearActivation activation_;
    torch::nn::LayerNorm norm1_{nullptr}, norm2_{nullptr};
    PackableLinear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
    PackableLinear feed_in_{nullptr}, feed_out_{nullptr};
};
TORCH_MODULE(ClipLayer);

}  // namespace item3d
