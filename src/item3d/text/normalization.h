// Unicode steps of the tokenizers, on UTF-8 strings.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// NFC, runs of white space to one space, lower case letter by letter (no final-sigma rule).
std::string normalize_for_clip(const std::string& text);

/// Splits as the regular expression 's|'t|'re|'ve|'m|'ll|'d|\p{L}+|\p{N}|[^\s\p{L}\p{N}]+ matches.
std::vector<std::string> split_for_clip(const std::string& text);

/// Splits as GPT-2's regular expression matches, which keeps every character:
/// 's|'t|'re|'ve|'m|'ll|'d| ?\p{L}+| ?\p{N}+| ?[^\s\p{L}\p{N}]+|\s+(?!\S)|\s+
std::vector<std::string> split_for_gpt2(const std::string& text);

/// BERT's: control characters go, white space becomes a space, CJK ideographs stand alone, accents
/// go (NFD without its non-spacing marks), lower case.
struct BertNormalization {
    bool lower_case = true;
    bool strip_accents = true;
    bool separate_ideographs = true;
};
std::string normalize_for_bert(const std::string& text, const BertNormalization& options);
/// Words between white space, each punctuation character by itself.
std::vector<std::string> split_for_bert(const std::string& text);

/// Ill-formed parts become U+FFFD; white space at both ends goes.
std::string to_valid_utf8(const std::string& bytes);
std::string strip_white_space(const std::string& text);

/// The code points of the 256 bytes in vocabularies of byte-level BPE, as UTF-8 (GPT-2's table).
const std::vector<std::string>& byte_symbols();

/// The bytes that a token of such a vocabulary stands for; its own where a symbol is none.
std::string bytes_of_symbols(const std::string& token);

/// Splits UTF-8 into code points.
std::vector<std::string> code_points(const std::string& text);

}  // namespace item3d
