// Byte pair encoding (Sennrich et al. 2016) over the 256 byte symbols of GPT-2, for the tokenizers
// of CLIP and OPT.
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
    using Vocabulary = std::unordered_map<std::string, int>;  ///< ids by token
    using Merges = std::vector<std::pair<std::string, std::string>>;

    /// merges: in order of priority. Both parts of a merge and their concatenation must be in the
    /// vocabulary; if not, throws InputError that calls the vocabulary `subject`. word_end: suffix
    /// of each word's last symbol ("</w>" for CLIP), or empty.
    BytePairs(Vocabulary vocabulary, Merges merges, std::string word_end,
              const std::string& subject);
    /// Reads vocab.json and merges.txt, or else tokenizer.json, in which transformers 5 and later
    /// keep both. Throws InputError.
    static BytePairs load(const std::filesystem::path& folder, const std::string& word_end);
    /// Writes vocab.json and merges.txt.
    void save(const std::filesystem::path& folder) const;

    /// Appends the ids of one word in UTF-8; bytes without a symbol become `unknown`.
    void append_word(const std::string& bytes, int unknown, std::vector<int>& ids) const;

    /// Adds a token that no merge produces. Returns its id, the new largest.
    int add_token(const std::string& token);

    /// Returns the id of a token as spelled in vocab.json ("red</w>"), or -1.
    int id_of(const std::string& token) const;
    /// Returns the token of an id, null if there is none.
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
    std::unordered_map<std::uint64_t, Merge> merges_;  ///< by the ids of both parts
    int largest_id_ = 0;
};

}  // namespace item3d
