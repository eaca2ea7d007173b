// Byte pair encoding (Sennrich et al. 2016) over the 256 byte symbols of GPT-2, which CLIP's and
// OPT's tokenizers share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace item3d {

class BytePairs {
  public:
    using Vocabulary = std::unordered_map<std::string, int>;  ///< token -> id
    using Merges = std::vector<std::pair<std::string, std::string>>;

    /// merges: in order of priority; both parts and their joint must be in the vocabulary.
    /// word_end: what the last symbol of each word carries ("</w>" of CLIP), or nothing. Throws
    /// InputError (calling the vocabulary `subject`) otherwise.
    BytePairs(Vocabulary vocabulary, Merges merges, std::string word_end,
              const std::string& subject);
    /// Reads vocab.json and merges.txt; where the former is missing, tokenizer.json, in which
    /// transformers keeps both since its fifth version. Throws InputError.
    static BytePairs load(const std::filesystem::path& folder, const std::string& word_end);
    /// Writes the same two files.
    void save(const std::filesystem::path& folder) const;

    /// Appends the ids of one word, given as UTF-8; bytes without a symbol become `unknown`.
    void append_word(const std::string& bytes, int unknown, std::vector<int>& ids) const;

    /// A token that no merge makes, under a new largest id, which is returned.
    int add_token(const std::string& token);

    /// The id of a token as vocab.json spells it ("red</w>"), or -1.
    int id_of(const std::string& token) const;
    /// Null for an id that is not there.
    const std::string* token_of(int id) const;
    std::size_t size() const { return id_of_.size(); }
    int largest_id() const { return largest_id_; }

  private:
    struct Merge {
        std::int64_t rank;
        int id;
    };
    std::string word_end_;
    Vocabulary id_of_;
    Merges merge_list_;
    std::unordered_map<int, std::string> token_of_;
    std::unordered_map<std::uint64_t, Merge> merges_;  ///< by both ids
    int largest_id_ = 0;
};

}  // namespace item3d
