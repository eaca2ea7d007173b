// Layers of networks that are only ever loaded, never trained: their tensors are not initialised,
// so that building a network of gigabytes touches no memory before load_parameters().
#pragma once

#include <torch/nn/module.h>
#include <torch/nn/pimpl.h>
#include <torch/types.h>

namespace item3d {

/// x W^T + b.
class LoadedLinearImpl : public torch::nn::Module {
  public:
    LoadedLinearImpl(std::int64_t inputs, std::int64_t outputs, bool with_bias = true) {
        weight = register_parameter("weight", torch::empty({outputs, inputs}));
        if (with_bias) bias = register_parameter("bias", torch::empty({outputs}));
    }
    torch::Tensor forward(const torch::Tensor& x) const { return at::linear(x, weight, bias); }

    torch::Tensor weight, bias;
};
TORCH_MODULE(LoadedLinear);

/// Rows of a table by index.
class LoadedEmbeddingImpl : public torch::nn::Module {
  public:
    LoadedEmbeddingImpl(std::int64_t rows, std::int64_t width) {
        weight = register_parameter("weight", torch::empty({rows, width}));
    }
    torch::Tensor forward(const torch::Tensor& ids) const { return at::embedding(weight, ids); }

    torch::Tensor weight;
};
TORCH_MODULE(LoadedEmbedding);

}  // namespace item3d
