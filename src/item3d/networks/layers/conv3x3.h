// The convolution that most of a diffusion network's time goes into.
#pragma once

#include "item3d/networks/layers/frozen_convolution.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/conv.h>

#include <functional>
#include <memory>
#include <mutex>

namespace item3d {

/// nn.Conv2d with kernel 3, stride 1, padding 1. Where neither weights nor bias ask for a gradient
/// it takes a faster way (frozen_convolution.h), if there is one, and its backward pass, which goes
/// to the input alone, keeps no activations. Weights may be changed at any time before
/// give_up_weights() or run_from(), but not while another thread runs the layer; several may.
class Conv3x3Impl : public torch::nn::Conv2dImpl {
  public:
    Conv3x3Impl(int in_channels, int out_channels, bool with_bias = true);
    at::Tensor forward(const at::Tensor& x);

    /// From now on the layer only runs: where the transformed weights are enough, it lets go of
    /// `weight` (which is then empty) as soon as it has them.
    void give_up_weights() { only_runs_ = true; }

    /// From now on the layer only runs, on the CPU, from weights as a file has them: contiguous,
    /// of any floating type. They are packed when it runs first, in the type of its input, and
    /// `forget` is called, which lets go of the memory that they take until they are looked at
    /// again.
    void run_from(const at::Tensor& stored, std::function<void()> forget);
    bool runs_from_file() const { return static_cast<bool>(forget_); }

  private:
    /// What convolves x, made when it is first asked for; null where that is the library.
    std::shared_ptr<FrozenConvolution> faster_way(const at::Tensor& x);
    /// Nothing is faster than the library for these weights: they are made ready for it.
    void take_from_file(at::ScalarType dtype);

    std::mutex mutex_;  ///< of all that faster_way() changes
    std::function<void()> forget_;
    std::shared_ptr<FrozenConvolution> fast_;
    bool only_runs_ = false;
    bool weight_given_up_ = false;
};
TORCH_MODULE(Conv3x3);

}  // namespace item3d
