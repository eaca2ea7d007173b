// Weights of one network, wherever the layout put them, into a torch module by name.
#pragma once

#include "item3d/models/safetensors.h"

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
    /// Throws InputError when none is there, or a shard or tensor that the index names is not.
    static Weights open(const std::filesystem::path& folder, const std::string& stem);
    /// One file.
    static Weights open_file(const std::filesystem::path& file);

    /// Gives tensors other names: old spellings, prefixes. An empty new name drops the tensor.
    void rename(const std::function<std::string(const std::string&)>& new_name);

    std::vector<std::string> names() const;
    bool contains(const std::string& name) const { return places_.count(name) > 0; }
    torch::Tensor tensor(const std::string& name) const;
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
    void add(SafeTensors file);

    std::string subject_;
    std::vector<SafeTensors> files_;
    std::map<std::string, Place> places_;
};

/// Sets every parameter (and persistent buffer) of `module` from the tensor of its name, converted
/// once to `device` and `dtype`; no gradient is asked of them. Floating-point tensors that need no
/// conversion stay in the memory map. Throws InputError naming file and tensor for one that is
/// missing, left over, of another shape, or not of floating point.
void load_parameters(torch::nn::Module& module, const Weights& weights,
                     torch::Device device = torch::kCPU, torch::Dtype dtype = torch::kFloat32);

/// Parameters and buffers of `module` by name, converted to `dtype`, for save_safetensors.
/// `prefix` is put before each name.
NamedTensors module_tensors(const torch::nn::Module& module, torch::Dtype dtype = torch::kFloat32,
                            const std::string& prefix = "");

/// Throws InputError when a network of `elements` parameters (a lower bound from its config) cannot
/// be in these weights: an absurd config must not make us allocate before the shapes are compared.
void check_plausible(const Weights& weights, double elements);

}  // namespace item3d
