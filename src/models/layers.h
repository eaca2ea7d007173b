// The layers that networks are made of, with PyTorch's parameter names and forward functions. Unlike
// torch::nn's they can be made without values: drawing the numbers of a network of a billion
// parameters only to overwrite them with a file's takes longer than reading the file.
#pragma once

#include <torch/nn/module.h>
#include <torch/nn/options/conv.h>
#include <torch/nn/options/embedding.h>
#include <torch/nn/options/linear.h>
#include <torch/nn/options/normalization.h>
#include <torch/nn/pimpl.h>
#include <torch/types.h>

namespace item3d {

using torch::nn::Conv2dOptions;
using torch::nn::GroupNormOptions;
using torch::nn::LayerNormOptions;
using torch::nn::LinearOptions;

/// While it lives, layers that this thread makes hold memory without values, to be overwritten by
/// load_parameters().
class WithoutValues {
  public:
    WithoutValues();
    ~WithoutValues();
    WithoutValues(const WithoutValues&) = delete;
    WithoutValues& operator=(const WithoutValues&) = delete;

  private:
    bool before_;
};

/// x [..., in] -> [..., out]. New ones have PyTorch's uniform values.
class LinearImpl : public torch::nn::Module {
  public:
    LinearImpl(std::int64_t in, std::int64_t out) : LinearImpl(LinearOptions(in, out)) {}
    explicit LinearImpl(const LinearOptions& options);
    torch::Tensor forward(const torch::Tensor& x) { return torch::linear(x, weight, bias); }

    torch::Tensor weight;  ///< [out, in]
    torch::Tensor bias;    ///< [out], or undefined
};
TORCH_MODULE(Linear);

/// x [N, in, H, W] -> [N, out, h, w]. New ones have PyTorch's uniform values.
class Conv2dImpl : public torch::nn::Module {
  public:
    /// Stride, padding with zeros and bias are honoured, nothing else.
    explicit Conv2dImpl(const Conv2dOptions& options);
    torch::Tensor forward(const torch::Tensor& x) {
        return torch::conv2d(x, weight, bias, stride_, padding_);
    }

    torch::Tensor weight;  ///< [out, in, kernel, kernel]
    torch::Tensor bias;    ///< [out], or undefined

  private:
    std::vector<std::int64_t> stride_, padding_;
};
TORCH_MODULE(Conv2d);

/// x [N, C, ...], normalised over groups of channels. New ones have weight 1 and bias 0.
class GroupNormImpl : public torch::nn::Module {
  public:
    explicit GroupNormImpl(const GroupNormOptions& options);
    torch::Tensor forward(const torch::Tensor& x) {
        return torch::group_norm(x, options_.num_groups(), weight, bias, options_.eps());
    }

    torch::Tensor weight, bias;  ///< [C]

  private:
    GroupNormOptions options_;
};
TORCH_MODULE(GroupNorm);

/// x [..., C], normalised over the last axis. New ones have weight 1 and bias 0.
class LayerNormImpl : public torch::nn::Module {
  public:
    explicit LayerNormImpl(const LayerNormOptions& options);
    torch::Tensor forward(const torch::Tensor& x) {
        return torch::layer_norm(x, options_.normalized_shape(), weight, bias, options_.eps());
    }

    torch::Tensor weight, bias;  ///< [C]

  private:
    LayerNormOptions options_;
};
TORCH_MODULE(LayerNorm);

/// Indices [...] -> [..., width]. New ones have standard normal values.
class EmbeddingImpl : public torch::nn::Module {
  public:
    EmbeddingImpl(std::int64_t count, std::int64_t width);
    torch::Tensor forward(const torch::Tensor& indices) {
        return torch::embedding(weight, indices);
    }

    torch::Tensor weight;  ///< [count, width]
};
TORCH_MODULE(Embedding);

}  // namespace item3d
