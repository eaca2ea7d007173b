// Transformer layer of BERT (Devlin et al. 2019) with optional cross-attention, for BLIP's text
// decoder and BLIP-2's Q-Former.
#pragma once

#include "item3d/networks/layers/key_value_cache.h"
#include "item3d/networks/layers/packable_linear.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/embedding.h>
#include <torch/nn/modules/normalization.h>

#include <string>

namespace item3d {

struct BertLayerOptions {
    int width = 768;
    int intermediate = 3072;
    int heads = 12;
    double epsilon = 1e-12;  ///< epsilon of the layer norms
    int memory_width = 0;  ///< channels of the cross-attention's source; 0 without cross-attention
    // Names of the layer's parts in files: "attention.NAME.query", "intermediateSUFFIX.dense".
    std::string attention_name = "self";
    std::string suffix;
};

/// Attention, followed by residual sum and layer norm.
class BertAttentionImpl : public torch::nn::Module {
  public:
    BertAttentionImpl(const BertLayerOptions& options, int source_width);
    /// Returns the keys and values of `source`, [N, T, source_width].
    KeyValues read(const at::Tensor& source);
    /// x is [N, S, width]. mask is empty, or additive and broadcastable to [N, heads, S, T].
    at::Tensor forward(const at::Tensor& x, const KeyValues& source, const at::Tensor& mask = {});

  private:
    int heads_;
    PackableLinear query_{nullptr}, key_{nullptr}, value_{nullptr}, output_{nullptr};
    torch::nn::LayerNorm norm_{nullptr};
};
TORCH_MODULE(BertAttention);

class BertLayerImpl : public torch::nn::Module {
  public:
    explicit BertLayerImpl(const BertLayerOptions& options);

    /// Returns the cross-attention's keys and values of image tokens [M, T, memory_width]; empty
    /// without cross-attention.
    KeyValues read_memory(const at::Tensor& memory);
    /// x is [N, S, width]. cache has the keys and values of the tokens before x, and those of x are
    /// appended to it; it is null if x begins the sequence. memory is [M, T, width], where M is a
    /// divisor of N: sequences i*N/M to (i+1)*N/M of x attend to image i.
    at::Tensor forward(at::Tensor x, const at::Tensor& mask, KeyValues* cache,
                       const KeyValues& memory);

  private:
    BertAttention self_{nullptr}, cross_{nullptr};
    PackableLinear feed_in_{nullptr}, feed_out_{nullptr};
    torch::nn::LayerNorm norm_{nullptr};
};
TORCH_MODULE(BertLayer);

}  // namespace item3d
