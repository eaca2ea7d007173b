// Loading of a file's weights into a torch module, by name.
#pragma once

#include "item3d/tensors/weights.h"

#include <c10/core/impl/LocalDispatchKeySet.h>
#include <torch/nn/module.h>

#include <string>

namespace item3d {

/// Returns the module that `make` makes, without running its random initialization. Its values are
/// undefined, and memory that is never written is never committed. Use it for modules whose
/// parameters and buffers all come from load_parameters(): initializing a Stable Diffusion U-Net
/// takes longer than reading its weights.
template <typename Make>
auto without_initial_values(const Make& make) {
    // In-place operations of the meta backend check shapes and leave values alone.
    // ForceDispatchKeyGuard restores all of the keys, while IncludeDispatchKeyGuard leaves the
    // backend's bit set (LibTorch 2.11).
    auto keys = c10::impl::tls_local_dispatch_key_set();
    keys.included_ = keys.included_.add(c10::DispatchKey::Meta);
    const c10::impl::ForceDispatchKeyGuard guard(keys);
    return make();
}

/// Intended use of a network's weights.
enum class WeightUse {
    any,
    /// The weights are frozen, and only the network reads them. On the CPU, weights that get packed
    /// then stay in the file until the first run (Conv3x3Impl::map_weights()), or keep the file's
    /// type (PackableLinearImpl::pack_stored()).
    running,
};

/// Sets every parameter (and persistent buffer) of `module` from the tensor of its name, converted
/// once to `device` and `dtype`, without gradient. Floating-point tensors that need no conversion
/// stay in the memory map. All names, shapes and types are checked before any tensor is read. With
/// at::kMeta as `device`, nothing is read after these checks. Throws InputError for a tensor that
/// is missing, superfluous, of another shape, or not of floating point. The error names the file
/// and the tensor, and says how many other tensors have problems.
void load_parameters(torch::nn::Module& module, const Weights& weights,
                     at::Device device = at::kCPU, at::ScalarType dtype = at::kFloat,
                     WeightUse use = WeightUse::any);

/// Returns parameters and buffers of `module` by name, converted to `dtype`, for save_safetensors.
/// `prefix` is put before each name.
NamedTensors module_tensors(const torch::nn::Module& module, at::ScalarType dtype = at::kFloat,
                            const std::string& prefix = "");

}  // namespace item3d
