// Byte-level BPE tokenizer of CLIP, as in transformers' CLIPTokenizer.
#pragma once

#include "item3d/tensors/tensor.h"
#include "item3d/text/byte_pairs.h"
#include "item3d/text/special_tokens.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace item3d {

class ClipTokenizer {
  public:
    using Vocabulary = BytePairs::Vocabulary;
    using Merges = BytePairs::Merges;

    struct Options {
        SpecialToken bos{"<|startoftext|>"};
        SpecialToken eos{"<|endoftext|>"};
        SpecialToken unk{"<|endoftext|>"};
        SpecialToken pad{"<|endoftext|>"};
        std::vector<SpecialToken> additional;
        int model_max_length = 77;
    };

    /// merges: in order of priority. Both parts of a merge, their concatenation, and the special
    /// tokens must be in the vocabulary; if not, throws InputError that calls the vocabulary
    /// `subject`.
    ClipTokenizer(Vocabulary vocabulary, Merges merges, const Options& options,
                  const std::string& subject = "vocabulary");
    /// Reads vocab.json, merges.txt, and the optional tokenizer_config.json and
    /// special_tokens_map.json. Throws InputError.
    static ClipTokenizer load(const std::filesystem::path& folder);
    /// Reads the same files, but vocab.json and merges.txt from `vocabulary_folder`.
    static ClipTokenizer load(const std::filesystem::path& folder,
                              const std::filesystem::path& vocabulary_folder);
    /// Writes the four files that load() reads.
    void save(const std::filesystem::path& folder) const;

    /// Returns the ids of the start token, the text and the end token, neither padded nor
    /// truncated. text is UTF-8; invalid bytes become U+FFFD.
    std::vector<int> encode(const std::string& text) const;
    /// Returns encode(), truncated or padded to `length` ids (0 for model_max_length).
    std::vector<int> encode_padded(const std::string& text, int length = 0) const;
    /// Returns encode_padded() of each text, [N, length] int64.
    at::Tensor encode_batch(const std::vector<std::string>& texts, int length = 0) const;
    /// Returns the part of a text that encode_padded() cuts off at the end; empty if the text fits.
    std::string lost_words(const std::string& text, int length = 0) const;
    /// Returns lower-case text with one space between words.
    std::string decode(const std::vector<int>& ids, bool skip_special_tokens = true) const;

    /// Adds a token for learned vectors. The token is matched in the lower-cased text before BPE,
    /// and stands for `count` new ids. TOKEN_1, TOKEN_2, ... stand for the second, third, ... of
    /// these ids alone (as in diffusers). Returns the first id. Throws InputError that names
    /// `subject` if the token is blank or exists already.
    int add_placeholder(const std::string& token, int count, const std::string& subject);

    /// Returns the pieces to which BPE is applied: normalised words, numbers, and runs of
    /// punctuation.
    static std::vector<std::string> split_words(const std::string& text);

    int bos_id() const { return pairs_.id_of(options_.bos.content); }
    int eos_id() const { return pairs_.id_of(options_.eos.content); }
    int pad_id() const { return pairs_.id_of(options_.pad.content); }
    int unk_id() const { return pairs_.id_of(options_.unk.content); }
    int model_max_length() const { return options_.model_max_length; }
    /// Returns the number of tokens.
    std::size_t size() const { return pairs_.size(); }
    int largest_id() const { return pairs_.largest_id(); }
    /// Returns the id of a token as spelled in vocab.json ("red</w>"), or -1.
    int id_of(const std::string& token) const { return pairs_.id_of(token); }

  private:
    ClipTokenizer(BytePairs pairs, const Options& options, const std::string& subject);
    void append_plain(const std::string& text, std::vector<int>& ids) const;

    Options options_;
    BytePairs pairs_;
    std::vector<std::pair<std::string, int>> raw_specials_, normalized_specials_;
    /// Number of ids of a placeholder, by its first id.
    std::unordered_map<int, int> placeholder_lengths_;
};

/// Warns which words of a text, called `subject`, are truncated.
void warn_of_lost_words(const ClipTokenizer& tokenizer, const std::string& subject,
                        const std::string& text, int length = 0);

}  // namespace item3d
