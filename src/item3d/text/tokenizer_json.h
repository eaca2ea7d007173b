// Reader of tokenizer.json, which replaces several older tokenizer files.
#pragma once

#include "item3d/core/config.h"
#include "item3d/text/special_tokens.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

/// Contents of a folder's tokenizer.json.
class TokenizerJson {
  public:
    /// Reads tokenizer.json. Returns nullopt if the file `instead` (vocab.json, vocab.txt) exists,
    /// or tokenizer.json does not. Throws InputError for a file that is damaged, or whose model is
    /// not of `type` ("BPE", "WordPiece").
    static std::optional<TokenizerJson> read(const std::filesystem::path& folder,
                                             const std::string& instead, const std::string& type);

    const std::string& subject() const { return file_.subject(); }
    /// Tokens and their ids, including added tokens.
    const std::vector<std::pair<std::string, int>>& vocabulary() const { return vocabulary_; }
    /// Returns the merges in order of priority.
    std::vector<std::pair<std::string, std::string>> merges() const;
    const std::vector<std::pair<int, SpecialToken>>& added_tokens() const { return added_; }

  private:
    explicit TokenizerJson(Config file);

    Config file_;
    std::vector<std::pair<std::string, int>> vocabulary_;
    std::vector<std::pair<int, SpecialToken>> added_;
};

/// Reads the ids of tokens from a JSON object. Throws InputError for an invalid id.
std::vector<std::pair<std::string, int>> read_ids(const Config& object);

}  // namespace item3d
