// Weights of one network, wherever the layout put them, into a torch module by name.
#pragma once

#include "item3d/tensors/safetensors.h"

#include <c10/core/impl/LocalDispatchKeySet.h>
#include <torch/nn/module.h>
#include <torch/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// All tensors of one network: a single file, shards named by an index, or their fp16 variant.
class Weights {
  public:
    /// Looks in `folder` for STEM.safetensors, STEM.safetensors.index.json, STEM.fp16.safetensors,
    /// STEM.safetensors.index.fp16.json and STEM.fp16.safetensors.index.json, in this order.
    /// Throws InputError when none is there (pickles are never read), a link leads nowhere, or a
    /// shard or tensor that the index names is not there.
    static Weights open(const std::filesystem::path& folder, const std::string& stem);
    /// One file.
    static Weights open_file(const std::filesystem::path& file);

    /// Gives tensors other names: old spellings, prefixes. An empty new name drops the tensor.
    void rename(const std::function<std::string(const std::string&)>& new_name);

    std::vector<std::string> names() const;
    bool contains(const std::string& name) const { return places_.count(name) > 0; }
    torch::Tensor tensor(const std::string& name) const;
    TensorInfo info(const std::string& name) const;
    void forget(const std::string& name) const;  ///< see SafeTensors
    /// The file that holds it, for messages.
    std::string file_of(const std::string& name) const;
    /// What messages call the whole.
    const std::string& subject() const { return subject_; }
    std::int64_t total_elements() const;

  private:
    struct Place {
        std::size_t file;
        std::string name;  ///< in the file
    };
    static Weights open_index(const std::filesystem::path& index);
    void add(SafeTensors file);
    const Place& place(const std::string& name) const;

    std::string subject_;
    std::vector<SafeTensors> files_;
    std::map<std::string, Place> places_;
};

/// The module that `make` makes, without what its constructors draw and fill in: the values are
/// whatever the memory holds, and memory that nobody writes takes no room. For modules all of whose
/// parameters and buffers come from load_parameters(): drawing a Stable Diffusion U-Net's random
/// start takes longer than reading its weights.
template <typename Make>
auto without_initial_values(const Make& make) {
    // In-place operations of the meta backend look at shapes and leave the values alone.
    const c10::impl::IncludeDispatchKeyGuard guard(c10::DispatchKey::Meta);
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
/// read; with torch::kMeta as `device`, that is all that happens. Throws InputError naming file and
/// tensor for one that is missing, left over, of another shape, or not of floating point, and how
/// many more there are.
void load_parameters(torch::nn::Module& module, const Weights& weights,
                     torch::Device device = torch::kCPU, torch::Dtype dtype = torch::kFloat32,
                     WeightUse use = WeightUse::any);

/// Parameters and buffers of `module` by name, converted to `dtype`, for save_safetensors.
/// `prefix` is put before each name.
NamedTensors module_tensors(const torch::nn::Module& module, torch::Dtype dtype = torch::kFloat32,
                            const std::string& prefix = "");

/// Throws InputError when a network of `elements` parameters (a lower bound from its config) cannot
/// be in these weights: an absurd config must not make us allocate before the shapes are compared.
void check_plausible(const Weights& weights, double elements);

}  // namespace item3d
