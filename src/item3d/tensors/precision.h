// The floating-point type in which a network computes.
#pragma once

#include "item3d/tensors/tensor.h"

#include <string>
#include <vector>

namespace item3d {

/// Returns "auto", "fp32", "bf16", "fp16".
const std::vector<std::string>& precision_names();

/// Returns the type of that name. "auto" means bf16 if the device supports it (any CUDA device,
/// CPUs with AVX512-BF16), else fp32. Throws InputError on an unknown name, and on fp16 on the CPU:
/// the CPU's fp16 kernels are slower than fp32, and overflow in Stable Diffusion's autoencoder.
at::ScalarType choose_precision(const std::string& name, at::Device device);

/// Returns "fp32", "bf16" or "fp16".
std::string precision_name(at::ScalarType dtype);

/// Remedy for predictions that are not finite, for error messages.
inline constexpr const char* overflow_hint =
    "use --precision fp32; if that does not help, the weights are damaged";

}  // namespace item3d
