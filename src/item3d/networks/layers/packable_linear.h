// Linear layers for inference with float32 activations. Their weights are packed, at a chosen
// precision, for a kernel of this project.
#pragma once

#include "item3d/kernels/cpu/linear/linear_activation.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/modules/linear.h>
#include <torch/nn/pimpl.h>

#include <optional>

namespace item3d {

/// Epilogue of a linear layer, whose result is f(x W^T + bias) + added, where f is the activation.
struct LinearEnd {
    LinearActivation activation = LinearActivation::none;
    at::Tensor added{};    ///< [..., O] or undefined
    bool rounded = false;  ///< with packed weights: rounds the result to the type of the products
};

/// Weights [O, I] of a linear layer, packed for products in float32 or bfloat16. Weights packed as
/// float16 are converted to float32 for the products, which is exact.
class PackedMatrix {
  public:
    /// True if this processor supports products with weights packed as `dtype`: AVX2, and for
    /// bfloat16 AVX-512's bfloat16 instructions. False on devices other than the CPU.
    static bool runs(at::Device device, at::ScalarType dtype);
    /// True if weights of this shape can be packed, that is, if I is a multiple of 16.
    static bool fits(const at::Tensor& weight);

    /// Rounds the weights to `dtype` (at::kFloat, at::kBFloat16 or at::kHalf).
    PackedMatrix(const at::Tensor& weight, at::ScalarType dtype);

    /// Multiplies x [..., I], which has the type multiplied_dtype(), or is float32 and gets rounded
    /// to that type. Returns [..., O], summed in float32. bias [O] and end.added are float32. Not
    /// differentiable.
    at::Tensor multiply(const at::Tensor& x, const at::Tensor& bias,
                        const LinearEnd& end = {}) const;
    /// Type of the products: at::kFloat or at::kBFloat16.
    at::ScalarType multiplied_dtype() const;
    /// Returns the rounded weights [O, I].
    at::Tensor unpacked() const;

  private:
    std::int64_t columns_, depth_;
    at::Tensor packed_;
};

/// nn.Linear that can replace its weights by packed ones.
class PackableLinearImpl : public torch::nn::LinearImpl {
  public:
    using LinearImpl::LinearImpl;
    at::Tensor forward(const at::Tensor& x, const LinearEnd& end = {});
    /// Converts x to forward()'s input type once, for several calls.
    at::Tensor as_read(const at::Tensor& x) const;

    /// Packs the weights, which must be float32, if they fit and the processor supports it;
    /// `weight` is then empty, and forward() is differentiable in x alone.
    void pack(at::ScalarType dtype);

    /// Packs a file's weights as float16, for a layer that runs in float32; `weight` is then empty.
    /// If this is impossible or gains nothing, returns false and has no effect.
    bool pack_stored(const at::Tensor& stored);

  private:
    bool multiplies_packed(const at::Tensor& x) const;

    std::optional<PackedMatrix> packed_;
};
TORCH_MODULE(PackableLinear);

/// Packs all PackableLinear layers of `module`.
void pack_linear_layers(const torch::nn::Module& module, at::ScalarType dtype);

}  // namespace item3d
