// Unicode normalisation and splitting for the tokenizers, on UTF-8 strings.
#pragma once

#include <string>
#include <vector>

namespace item3d {

/// Applies NFC, collapses white space to one space, and lower-cases letter by letter (no
/// final-sigma rule).
std::string normalize_for_clip(const std::string& text);

/// Splits text into matches of the regular expression
/// 's|'t|'re|'ve|'m|'ll|'d|\p{L}+|\p{N}|[^\s\p{L}\p{N}]+
std::vector<std::string> split_for_clip(const std::string& text);

/// Splits text into matches of GPT-2's regular expression, which keeps every character:
/// 's|'t|'re|'ve|'m|'ll|'d| ?\p{L}+| ?\p{N}+| ?[^\s\p{L}\p{N}]+|\s+(?!\S)|\s+
std::vector<std::string> split_for_gpt2(const std::string& text);

/// Normalisation of BERT: removes control characters, turns white space into spaces, isolates CJK
/// ideographs, strips accents (NFD without non-spacing marks), lower-cases.
struct BertNormalization {
    bool lower_case = true;
    bool strip_accents = true;
    bool separate_ideographs = true;
};
std::string normalize_for_bert(const std::string& text, const BertNormalization& options);
/// Splits text at white space. Each punctuation character becomes a part of its own.
std::vector<std::string> split_for_bert(const std::string& text);

/// Replaces parts that are not valid UTF-8 by U+FFFD.
std::string to_valid_utf8(const std::string& bytes);
std::string strip_white_space(const std::string& text);

/// Returns the symbols of the 256 bytes in vocabularies of byte-level BPE, as UTF-8 (GPT-2's
/// table).
const std::vector<std::string>& byte_symbols();

/// Returns the bytes of a token in a vocabulary of byte-level BPE. A character that is not a symbol
/// keeps its own bytes.
std::string bytes_of_symbols(const std::string& token);

/// Splits UTF-8 into code points.
std::vector<std::string> code_points(const std::string& text);

}  // namespace item3d
