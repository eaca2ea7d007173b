// Multi-head attention, in the fastest implementation for each case.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns softmax(q k^T / sqrt(d) + mask) v for each of `heads` heads. query is [N, S, C], key and
/// value are [N, T, C], the result is [N, S, C]. mask is empty, or additive and broadcastable to
/// [N, heads, S, T]. Without gradients and mask, on a CPU with AVX2 or AVX-512, a kernel of this
/// project computes it. With gradients, on a CPU and for few tokens, it is computed as matrix
/// product, softmax, matrix product. This is 1.5 times faster there than LibTorch's fused kernel,
/// whose backward pass takes a third of a training step. In all other cases LibTorch's fused kernel
/// computes it.
at::Tensor attention(const at::Tensor& query, const at::Tensor& key, const at::Tensor& value,
                     int heads, const at::Tensor& mask = {});

}  // namespace item3d
