// Gradient checkpointing, which needs less memory for gradients and more time.
#pragma once

#include "item3d/tensors/tensor.h"

#include <functional>

namespace item3d {

/// Returns f(x) without keeping activations: the backward pass computes f again (Chen et al. 2016,
/// "Training Deep Nets with Sublinear Memory Cost"). The gradient goes to x alone, so f's
/// parameters must not require one. f must be deterministic and outlive the result's graph.
at::Tensor recomputed(std::function<at::Tensor(const at::Tensor&)> f, const at::Tensor& x);

}  // namespace item3d
