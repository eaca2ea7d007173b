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
    /// The settings and input that the state belongs to. A resume with other ones is refused: its
    /// result would be neither the one nor the other.
    nlohmann::json identity;
    std::int64_t iteration = 0;  ///< iterations done
    NamedTensors tensors;
};

/// Of a large tensor most of whose rows are 0 (what no step has touched) the other rows are
/// written.
void save_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// No value when there is no file. Throws InputError when it is broken.
std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& path);

/// A file's content as 16 hexadecimal digits, for an identity.
std::string hash_of_file(const std::filesystem::path& path);
/// The content of a prior's networks in the same way, unless they only judge; files that are not
/// there have none. Reads all of them, a second for each gigabyte or two.
std::string hash_of_weights(const std::filesystem::path& prior);

/// Throws InputError that names `path` and the first key of `now` whose value `saved` has not.
/// inputs: what to say of keys that are hashes ("model": "belongs to another model file").
void require_same_identity(const std::filesystem::path& path, const nlohmann::json& saved,
                           const nlohmann::json& now,
                           const std::map<std::string, std::string>& inputs);

/// Appends parameters as they are, named prefix + their own names.
void append_parameters(NamedTensors& tensors, const std::string& prefix,
                       const NamedTensors& parameters);

/// A checkpoint's tensors by name. What is missing or of another shape is an InputError.
class CheckpointReader {
  public:
    CheckpointReader(std::string subject, const NamedTensors& tensors);

    bool has(const std::string& name) const { return tensors_.count(name) != 0; }
    at::Tensor get(const std::string& name) const;
    /// Copied into `target`, which has its shape.
    void copy(const std::string& name, at::Tensor target) const;
    /// Copies what append_parameters() wrote into these parameters.
    void parameters(const std::string& prefix, const NamedTensors& parameters) const;
    /// What begins with prefix, without it.
    std::map<std::string, at::Tensor> with_prefix(const std::string& prefix) const;

  private:
    std::string subject_;
    std::map<std::string, at::Tensor> tensors_;
};

}  // namespace item3d
