// Tokens that a tokenizer finds in the text as a whole, before it splits words.
#pragma once

#include "item3d/core/config.h"

#include <string>
#include <utility>
#include <vector>

namespace item3d {

struct SpecialToken {
    std::string content;
    /// True: looked for after the text was normalised; false: in the text as it was written.
    bool normalized = false;
};

/// A key of tokenizer_config.json or special_tokens_map.json: a plain string or an AddedToken
/// object. Throws InputError for one that takes white space with it.
SpecialToken read_special_token(const Config& config, const std::string& key,
                                const SpecialToken& fallback);

/// The "added_tokens_decoder" of newer files: all of them with their ids; empty without one.
std::vector<std::pair<int, SpecialToken>> read_added_tokens(const Config& config);

/// Cuts `text` at the leftmost, there longest, special tokens: calls plain(piece) and special(id).
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
