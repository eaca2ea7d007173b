// Less memory for gradients, more time.
#pragma once

#include "item3d/tensors/tensor.h"

#include <functional>

namespace item3d {

/// f(x), without keeping what its backward pass needs: that computes f again (Chen et al. 2016,
/// "Training Deep Nets with Sublinear Memory Cost"). The gradient goes to x alone, so f's
/// parameters must not ask for one. f must live as long as the result's graph, and give the same
/// again.
at::Tensor recomputed(std::function<at::Tensor(const at::Tensor&)> f, const at::Tensor& x);

}  // namespace item3d
