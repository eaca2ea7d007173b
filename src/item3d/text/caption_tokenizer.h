// What the captioning networks ask of a tokenizer, and the two that they come with.
#pragma once

#include "item3d/text/byte_pairs.h"
#include "item3d/text/normalization.h"
#include "item3d/text/special_tokens.h"

#include <filesystem>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace item3d {

class CaptionTokenizer {
  public:
    virtual ~CaptionTokenizer() = default;
    /// With the special tokens that the network's prompts begin and end with. text: UTF-8.
    virtual std::vector<int> encode(const std::string& text) const = 0;
    /// Special tokens are left out.
    virtual std::string decode(const std::vector<int>& ids) const = 0;
    virtual int largest_id() const = 0;
};

/// WordPiece (Schuster and Nakajima 2012) as transformers' BertTokenizer does it: "[CLS] text
/// [SEP]".
class BertTokenizer : public CaptionTokenizer {
  public:
    /// Reads vocab.txt and tokenizer_config.json (the latter may be missing). Throws InputError.
    static BertTokenizer load(const std::filesystem::path& folder);

    std::vector<int> encode(const std::string& text) const override;
    std::string decode(const std::vector<int>& ids) const override;
    int largest_id() const override { return static_cast<int>(tokens_.size()) - 1; }

  private:
    void append_word(const std::string& word, std::vector<int>& ids) const;

    BertNormalization normalization_;
    std::vector<std::string> tokens_;  ///< by id
    std::unordered_map<std::string, int> id_of_;
    std::vector<std::pair<std::string, int>> specials_;
    int unknown_ = 0, begin_ = 0, end_ = 0;
};

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
