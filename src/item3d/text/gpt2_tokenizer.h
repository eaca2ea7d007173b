// Byte-level BPE tokenizer of GPT-2, for BLIP-2's captioners.
#pragma once

#include "item3d/text/byte_pairs.h"
#include "item3d/text/caption_tokenizer.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Byte-level BPE as in transformers' GPT2Tokenizer, with OPT's start token: "</s>text".
class Gpt2Tokenizer : public CaptionTokenizer {
  public:
    /// Reads vocab.json, merges.txt, and the optional tokenizer_config.json,
    /// special_tokens_map.json and added_tokens.json. Throws InputError.
    static Gpt2Tokenizer load(const std::filesystem::path& folder);

    std::vector<int> encode(const std::string& text) const override;
    std::string decode(const std::vector<int>& ids) const override;
    int largest_id() const override;

  private:
    explicit Gpt2Tokenizer(BytePairs pairs) : pairs_(std::move(pairs)) {}

    BytePairs pairs_;
    std::vector<std::pair<std::string, int>> specials_;
    /// Tokens that are matched as a whole, but are not special.
    std::vector<std::pair<std::string, int>> added_;
    int begin_ = -1;  ///< token before the text; -1 if none
    int unknown_ = 0;
};

}  // namespace item3d
