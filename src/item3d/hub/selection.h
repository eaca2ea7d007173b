// The selection of a repository's files for a prior.
#pragma once

#include <string>
#include <vector>

namespace item3d {

struct FileSelection {
    /// Everything but shards: configurations, tokenizers, unsharded weights.
    std::vector<std::string> files;
    /// Indexes whose shards are needed too (shards_of_index()).
    std::vector<std::string> indexes;
};

/// Selects files. model_index: the text of model_index.json; files: all paths of the repository;
/// variant: "" for full weights if available, or "fp16" for half-precision ones if available.
/// Excludes parts that item3d does not use (safety checker, feature extractor, depth estimator),
/// and every format but safetensors. Throws InputError that names `repository` when it has no
/// parts, a part has only pickled weights or none, or no part has the variant.
FileSelection select_files(const std::string& repository, const std::string& model_index,
                           const std::vector<std::string>& files, const std::string& variant);

/// Returns the shards that an index's text names, as paths in the repository. Throws InputError
/// when one is not beside the index or not among `files`.
std::vector<std::string> shards_of_index(const std::string& repository, const std::string& index,
                                         const std::string& text,
                                         const std::vector<std::string>& files);

/// Throws InputError unless `repository` looks like a diffusers model. The message names
/// single-file checkpoints or pickles that were found instead.
void check_layout(const std::string& repository, const std::vector<std::string>& files);

}  // namespace item3d
