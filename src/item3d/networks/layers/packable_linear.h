// Linear layers of networks that only run: their weights in the order that a kernel of our own
// wants them, at the precision that is asked for, between activations in float32.
#pragma once

#include "item3d/kernels/cpu/linear/linear_activation.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/linear.h>
#include <torch/nn/pimpl.h>

#include <optional>

namespace item3d {

/// What becomes of a linear layer's sums: f(x W^T + bias) + added.
struct LinearEnd {
    LinearActivation activation = LinearActivation::none;
    at::Tensor added{};    ///< [..., O] or undefined
    bool rounded = false;  ///< where weights are packed: the result in the type they multiply
};

/// The weights [O, I] of a linear layer, packed for products in float32 or bfloat16: packed in
/// float16 they are multiplied in float32, exactly.
class PackedMatrix {
  public:
    /// Whether this processor has what products with weights packed in `dtype` need: AVX2, and for
    /// bfloat16 AVX-512's instructions for that. Never on another device.
    static bool runs(at::Device device, at::ScalarType dtype);
    /// Whether weights of this shape can be packed: I a multiple of 16.
    static bool fits(const at::Tensor& weight);

    /// Rounds the weights to `dtype` (at::kFloat, at::kBFloat16 or at::kHalf).
    PackedMatrix(const at::Tensor& weight, at::ScalarType dtype);

    /// x [..., I] float32, rounded to multiplied_dtype(), or of that type -> [..., O], summed in
    /// float32; bias [O] and end.added float32. Not differentiable.
    at::Tensor multiply(const at::Tensor& x, const at::Tensor& bias,
                        const LinearEnd& end = {}) const;
    /// What the weights are multiplied by: at::kFloat or at::kBFloat16.
    at::ScalarType multiplied_dtype() const;
    /// The rounded weights [O, I].
    at::Tensor unpacked() const;

  private:
    std::int64_t columns_, depth_;
    at::Tensor packed_;
};

/// nn.Linear that can be told to keep nothing but packed weights.
class PackableLinearImpl : public torch::nn::LinearImpl {
  public:
    using LinearImpl::LinearImpl;
    at::Tensor forward(const at::Tensor& x, const LinearEnd& end = {});
    /// x as forward() reads it, for who calls it several times.
    at::Tensor as_read(const at::Tensor& x) const;

    /// Packs the weights, which must be in float32, where they fit and the processor can use them;
    /// `weight` is empty then. What follows is differentiable in x alone.
    void pack(at::ScalarType dtype);

    /// Packs weights as a file has them, in float16, for a layer that runs in float32; `weight` is
    /// empty then. False, and nothing done, where that cannot be or gains nothing.
    bool pack_stored(const at::Tensor& stored);

  private:
    bool multiplies_packed(const at::Tensor& x) const;

    std::optional<PackedMatrix> packed_;
};
TORCH_MODULE(PackableLinear);

/// Packs all layers of that kind in `module`.
void pack_linear_layers(const torch::nn::Module& module, at::ScalarType dtype);

}  // namespace item3d
