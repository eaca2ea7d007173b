// The weights of one network, by name, from any file layout.
#pragma once

#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace item3d {

/// All tensors of one network. They are in a single file, or in shards that an index names, or in
/// the fp16 variant of these files.
class Weights {
  public:
    /// Looks in `folder` for STEM.safetensors, STEM.safetensors.index.json, STEM.fp16.safetensors,
    /// STEM.fp16.safetensors.index.json and STEM.safetensors.index.fp16.json, in this order. Throws
    /// InputError when none exists (pickles are never read), for a dangling link, and for a missing
    /// shard or tensor of the index.
    static Weights open(const std::filesystem::path& folder, const std::string& stem);
    /// Opens one file.
    static Weights open_file(const std::filesystem::path& file);

    /// Renames tensors, to replace old spellings and prefixes. An empty new name drops the tensor.
    void rename(const std::function<std::string(const std::string&)>& new_name);

    std::vector<std::string> names() const;
    bool contains(const std::string& name) const { return places_.count(name) > 0; }
    at::Tensor tensor(const std::string& name) const;
    TensorInfo info(const std::string& name) const;
    void release_pages(const std::string& name) const;  ///< see SafeTensors
    /// Returns the path of the file that contains the tensor, for messages.
    std::string file_of(const std::string& name) const;
    /// Returns the path of the single file or of the index, for messages.
    const std::string& subject() const { return subject_; }
    std::int64_t total_elements() const;

  private:
    struct Place {
        std::size_t file;
        std::string name;  ///< name in the file
    };
    static Weights open_index(const std::filesystem::path& index);
    void add(SafeTensors file);
    const Place& place(const std::string& name) const;

    std::string subject_;
    std::vector<SafeTensors> files_;
    std::map<std::string, Place> places_;
};

/// Throws InputError if the weights have fewer than `elements` numbers. `elements` is a lower bound
/// of the network's parameters, computed from its config. The check prevents huge allocations for a
/// bad config before shapes are compared.
void check_plausible(const Weights& weights, double elements);

}  // namespace item3d
