// What lies in a prior's folder beside the networks: prior.json, and the folders of CLIP, the
// captioner and the segmenter.
#pragma once

#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>
#include <string>

namespace item3d {

/// Sub-folders of the prior's.
inline constexpr const char* clip_folder = "clip";
inline constexpr const char* captioner_folder = "captioner";
inline constexpr const char* segmenter_folder = "segmenter";

/// The folder's prior.json; an empty object where there is none or no object in it.
nlohmann::json read_prior_json(const std::filesystem::path& folder);

/// Puts these members into the folder's prior.json, which is made if there is none; others are
/// kept. Returns what it then holds.
nlohmann::json update_prior_json(const std::filesystem::path& folder,
                                 const nlohmann::json& members);

/// The words that the prior in `folder` was trained on: those of its prior.json, or, where that has
/// none, those of today's captions that its tokenizer has whole.
std::set<std::string> trained_words(const std::filesystem::path& folder,
                                    const ClipTokenizer& tokenizer);

}  // namespace item3d
