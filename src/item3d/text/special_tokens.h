// Special tokens, which are matched as a whole before the text is split into words.
#pragma once

#include "item3d/core/config.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

struct SpecialToken {
    std::string content;
    /// True if the token is matched in the normalised text, false if in the original text.
    bool normalized = false;
};

/// Reads a key of tokenizer_config.json or special_tokens_map.json: a plain string or an AddedToken
/// object. Throws InputError for a token that strips white space.
SpecialToken read_special_token(const Config& config, const std::string& key,
                                const SpecialToken& fallback);

/// Reads "added_tokens_decoder" of newer files: all tokens with their ids. Returns an empty list if
/// the key is missing.
std::vector<std::pair<int, SpecialToken>> read_added_tokens(const Config& config);

/// Splits `text` at its special tokens, and calls plain(piece) and special(id). The leftmost token
/// is matched first; if several tokens begin there, the longest.
template <typename Plain, typename Special>
void cut_at_specials(const std::string& text,
                     const std::vector<std::pair<std::string, int>>& specials, const Plain& plain,
                     const Special& special) {
    std::size_t begin = 0;
    while (begin < text.size()) {
        std::size_t at = std::string::npos;
        const std::pair<std::string, int>* best = nullptr;
        for (const auto& candidate : specials) {
            const std::size_t found = text.find(candidate.first, begin);
            if (found == std::string::npos) continue;
            if (!best || found < at ||
                (found == at && candidate.first.size() > best->first.size())) {
                at = found;
                best = &candidate;
            }
        }
        if (!best) {
            plain(text.substr(begin));
            return;
        }
        if (at > begin) plain(text.substr(begin, at - begin));
        special(best->second);
        begin = at + best->first.size();
    }
}

}  // namespace item3d
