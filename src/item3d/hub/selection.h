// The selection of a repository's files for a prior.
#pragma once

#include <string>
#include <vector>

namespace item3d {

struct FileSelection {
    /// All files but shards: configurations, tokenizers, unsharded weights.
    std::vector<std::string> files;
    /// Indexes whose shards are needed too (shards_of_index()).
    std::vector<std::string> indexes;
};

/// Selects the files that item3d uses. Leaves out the parts that it does not use (safety checker,
/// feature extractor, depth estimator), and weights in every format but safetensors. model_index:
/// the text of model_index.json; files: all paths of the repository; variant: "" prefers full
/// weights, "fp16" prefers half-precision ones. Throws InputError that names `repository` if it has
/// no parts, if a part has only pickled weights or no weights, or if no part has the variant.
FileSelection select_files(const std::string& repository, const std::string& model_index,
                           const std::vector<std::string>& files, const std::string& variant);

/// Returns the shards that an index names, as paths in the repository. index: the index's path;
/// text: its content. Throws InputError if a shard is not beside the index or not among `files`.
std::vector<std::string> shards_of_index(const std::string& repository, const std::string& index,
                                         const std::string& text,
                                         const std::vector<std::string>& files);

/// Throws InputError unless `repository` looks like a diffusers model. The message names the
/// single-file checkpoints or pickles that the repository has instead.
void check_layout(const std::string& repository, const std::vector<std::string>& files);

}  // namespace item3d
