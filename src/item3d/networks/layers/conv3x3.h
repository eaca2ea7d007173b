// 3x3 convolution, which takes most of a diffusion network's time.
#pragma once

#include "item3d/networks/layers/frozen_convolution.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>

#include <functional>
#include <memory>
#include <mutex>

namespace item3d {

/// nn.Conv2d with kernel 3, stride 1, padding 1. If neither weights nor bias require a gradient, a
/// faster implementation (frozen_convolution.h) runs where one applies. Its backward pass computes
/// the input's gradient alone, and keeps no activations. Several threads may run the layer. Weights
/// may be changed before release_weights() or map_weights(), but not while a thread runs the layer.
class Conv3x3Impl : public torch::nn::Conv2dImpl {
  public:
    Conv3x3Impl(int in_channels, int out_channels, bool with_bias = true);
    at::Tensor forward(const at::Tensor& x);

    /// Marks the layer as inference-only. It releases `weight` as soon as the packed weights
    /// suffice; `weight` is then empty.
    void release_weights() { only_runs_ = true; }

    /// Marks the layer as inference-only on the CPU, with weights `stored` in a file. They must be
    /// contiguous, of any floating type. The first run packs them in the type of its input. It then
    /// calls `release_pages`, which releases the memory of the stored weights until they are read
    /// again.
    void map_weights(const at::Tensor& stored, std::function<void()> release_pages);
    bool runs_from_file() const { return static_cast<bool>(release_pages_); }

  private:
    /// Returns the faster implementation for x, made on first use; null if LibTorch's is used.
    std::shared_ptr<FrozenConvolution> faster_way(const at::Tensor& x);
    /// Loads the weights from the file for LibTorch's implementation, if no other one is faster.
    void take_from_file(at::ScalarType dtype);

    std::mutex mutex_;  ///< guards all that faster_way() changes
    std::function<void()> release_pages_;
    std::shared_ptr<FrozenConvolution> fast_;
    bool only_runs_ = false;
    bool weight_given_up_ = false;
};
TORCH_MODULE(Conv3x3);

}  // namespace item3d
