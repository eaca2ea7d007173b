// Less memory for gradients, more time.
#pragma once

#include <torch/types.h>

#include <functional>

namespace item3d {

/// f(x), without keeping what its backward pass needs: that computes f again (Chen et al. 2016,
/// "Training Deep Nets with Sublinear Memory Cost"). The gradient goes to x alone, so f's
/// parameters must not ask for one. f must live as long as the result's graph, and give the same
/// again.
torch::Tensor recomputed(std::function<torch::Tensor(const torch::Tensor&)> f,
                         const torch::Tensor& x);

}  // namespace item3d
