// WordPiece tokenizer of BERT, for BLIP's captioners.
#pragma once

#include "item3d/text/caption_tokenizer.h"
#include "item3d/text/normalization.h"

#include <filesystem>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace item3d {

/// WordPiece (Schuster and Nakajima 2012) as in transformers' BertTokenizer: "[CLS] text [SEP]".
class BertTokenizer : public CaptionTokenizer {
  public:
    /// Reads vocab.txt, or else tokenizer.json, and the optional tokenizer_config.json. Throws
    /// InputError.
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

}  // namespace item3d
