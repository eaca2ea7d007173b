// GPT-2's byte-level BPE tokenizer, which BLIP-2's captioners come with.
#pragma once

#include "item3d/text/byte_pairs.h"
#include "item3d/text/caption_tokenizer.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Byte-level BPE as transformers' GPT2Tokenizer does it: "</s>text" as OPT wants it.
class Gpt2Tokenizer : public CaptionTokenizer {
  public:
    /// Reads vocab.json and merges.txt, tokenizer_config.json, special_tokens_map.json and
    /// added_tokens.json (these three may be missing). Throws InputError.
    static Gpt2Tokenizer load(const std::filesystem::path& folder);

    std::vector<int> encode(const std::string& text) const override;
    std::string decode(const std::vector<int>& ids) const override;
    int largest_id() const override;

  private:
    explicit Gpt2Tokenizer(BytePairs pairs) : pairs_(std::move(pairs)) {}

    BytePairs pairs_;
    std::vector<std::pair<std::string, int>> specials_;
    std::vector<std::pair<std::string, int>> added_;  ///< found whole too, but they are text
    int begin_ = -1;                                  ///< put before the text; -1: nothing is
    int unknown_ = 0;
};

}  // namespace item3d
