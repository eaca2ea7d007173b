// The state of an unfinished run: one safetensors file, replaced atomically.
#pragma once

#include "item3d/tensors/safetensors.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct Checkpoint {
    /// Settings and inputs of the run that wrote the checkpoint. A run with other settings or
    /// inputs cannot resume from it, because the result would match neither run.
    nlohmann::json identity;
    std::int64_t iteration = 0;  ///< iterations done
    NamedTensors tensors;
};

/// Saves a checkpoint. If most rows of a large tensor are 0 (not yet updated), only the other rows
/// are stored.
void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Loads a checkpoint. Returns no value if there is no file. Throws InputError if the file is
/// damaged.
std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& path);

/// Returns the hash of a file's content as 16 hexadecimal digits, for use in Checkpoint::identity.
std::string hash_of_file(const std::filesystem::path& path);
/// Returns the hash of the weights of a prior's U-Net, text encoders and autoencoder. Missing files
/// are skipped. Reads the files whole, which takes about a second for a gigabyte or two.
std::string hash_of_weights(const std::filesystem::path& prior);

/// Throws InputError that names `path` and the first key of `now` whose value differs in `saved`.
/// inputs: the message for each key whose value is a file's hash ("model": "belongs to another
/// model file").
void require_same_identity(const std::filesystem::path& path, const nlohmann::json& saved,
                           const nlohmann::json& now,
                           const std::map<std::string, std::string>& inputs);

/// Appends parameters without copying them. `prefix` is put before their names.
void append_parameters(NamedTensors& tensors, const std::string& prefix,
                       const NamedTensors& parameters);

/// A checkpoint's tensors by name. Throws InputError for a missing tensor or another shape.
class CheckpointReader {
  public:
    CheckpointReader(std::string subject, const NamedTensors& tensors);

    bool has(const std::string& name) const { return tensors_.count(name) != 0; }
    at::Tensor get(const std::string& name) const;
    /// Copies a tensor into `target`, which must have its shape.
    void copy(const std::string& name, at::Tensor target) const;
    /// Copies the tensors of append_parameters() into these parameters.
    void parameters(const std::string& prefix, const NamedTensors& parameters) const;
    /// Returns the tensors whose names begin with `prefix`; the returned names lack the prefix.
    std::map<std::string, at::Tensor> with_prefix(const std::string& prefix) const;

  private:
    std::string subject_;
    std::map<std::string, at::Tensor> tensors_;
};

}  // namespace item3d
