// Which of a repository's files a prior needs.
#pragma once

#include <string>
#include <vector>

namespace item3d {

struct FileSelection {
    /// Everything but shards: configurations, tokenizers, weights in one file.
    std::vector<std::string> files;
    /// Indexes whose shards are needed too (shards_of_index).
    std::vector<std::string> indexes;
};

/// model_index: the text of model_index.json; files: all paths of the repository; variant: "" for
/// full weights where there are any, or "fp16" for the half-sized ones where there are any.
/// Parts that item3d does not use (safety checker, feature extractor, depth estimator) are left
/// out, as is every format but safetensors. Throws InputError that names `repository` when it has
/// no parts, a part has only pickled weights or none, or no part has the variant.
FileSelection select_files(const std::string& repository, const std::string& model_index,
                           const std::vector<std::string>& files, const std::string& variant);

/// The shards that the text of an index names, as paths in the repository. Throws InputError when
/// one is not beside the index or not among `files`.
std::vector<std::string> shards_of_index(const std::string& repository, const std::string& index,
                                         const std::string& text,
                                         const std::vector<std::string>& files);

/// Throws InputError unless `repository` looks like a diffusers model: says whether it holds single
/// checkpoints or pickles instead.
void check_layout(const std::string& repository, const std::vector<std::string>& files);

}  // namespace item3d
