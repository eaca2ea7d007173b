// Files of a prior's folder besides its diffusion networks: prior.json, and the sub-folders of
// CLIP, captioner and segmenter.
#pragma once

#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>
#include <string>

namespace item3d {

/// Sub-folders of a prior's folder.
inline constexpr const char* clip_folder = "clip";
inline constexpr const char* captioner_folder = "captioner";
inline constexpr const char* segmenter_folder = "segmenter";

/// Reads the folder's prior.json. Returns an empty object if the file is missing or holds no
/// object.
nlohmann::json read_prior_json(const std::filesystem::path& folder);

/// Merges `members` into the folder's prior.json, which is created if missing. Its other members
/// are kept. Returns the merged object.
nlohmann::json update_prior_json(const std::filesystem::path& folder,
                                 const nlohmann::json& members);

/// Returns the words that the prior in `folder` was trained on, from its prior.json. If prior.json
/// lists no words, returns the words of today's training captions that are single tokens of the
/// tokenizer.
std::set<std::string> trained_words(const std::filesystem::path& folder,
                                    const ClipTokenizer& tokenizer);

}  // namespace item3d
