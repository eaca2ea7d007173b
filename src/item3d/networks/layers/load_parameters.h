// A file's weights into a torch module, by name.
#pragma once

#include "item3d/tensors/weights.h"

#include <c10/core/impl/LocalDispatchKeySet.h>
#include <torch/nn/module.h>

#include <string>

namespace item3d {

/// The module that `make` makes, without what its constructors draw and fill in: the values are
/// whatever the memory holds, and memory that nobody writes takes no room. For modules all of whose
/// parameters and buffers come from load_parameters(): drawing a Stable Diffusion U-Net's random
/// start takes longer than reading its weights.
template <typename Make>
auto without_initial_values(const Make& make) {
    // In-place operations of the meta backend look at shapes and leave the values alone. The guard
    // restores all of the keys: IncludeDispatchKeyGuard leaves the backend's bit set
    // (LibTorch 2.11).
    auto keys = c10::impl::tls_local_dispatch_key_set();
    keys.included_ = keys.included_.add(c10::DispatchKey::Meta);
    const c10::impl::ForceDispatchKeyGuard guard(keys);
    return make();
}

/// What becomes of a network's weights.
enum class WeightUse {
    any,
    /// They stay as they are, and nobody but the network itself looks at them: on the CPU, those
    /// that it packs anyway stay in the file until it runs (Conv3x3Impl::run_from()), or stay of
    /// the file's type (PackableLinearImpl::pack_stored()).
    running,
};

/// Sets every parameter (and persistent buffer) of `module` from the tensor of its name, converted
/// once to `device` and `dtype`; no gradient is asked of them. Floating-point tensors that need no
/// conversion stay in the memory map. All names, shapes and types are compared before anything is
/// read; with at::kMeta as `device`, that is all that happens. Throws InputError naming file and
/// tensor for one that is missing, left over, of another shape, or not of floating point, and how
/// many more there are.
void load_parameters(torch::nn::Module& module, const Weights& weights,
                     at::Device device = at::kCPU, at::ScalarType dtype = at::kFloat,
                     WeightUse use = WeightUse::any);

/// Parameters and buffers of `module` by name, converted to `dtype`, for save_safetensors.
/// `prefix` is put before each name.
NamedTensors module_tensors(const torch::nn::Module& module, at::ScalarType dtype = at::kFloat,
                            const std::string& prefix = "");

}  // namespace item3d
