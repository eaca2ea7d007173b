#include "item3d/prior/training/tokenizer_training.h"

#include "item3d/core/error.h"
#include "item3d/text/normalization.h"

#include <map>

namespace item3d {
namespace {

using Pair = std::pair<std::string, std::string>;

bool printable(int byte) {
    return (byte >= '!' && byte <= '~') || (byte >= 0xa1 && byte <= 0xac) || byte >= 0xae;
}

struct Spelling {
    std::vector<std::string> symbols;
    std::int64_t count;
};

/// Returns the most frequent pair of neighbouring symbols; ties go to the first pair in byte order.
Pair commonest_pair(const std::vector<Spelling>& words) {
    std::map<Pair, std::int64_t> counts;
    for (const Spelling& word : words)
        for (std::size_t i = 0; i + 1 < word.symbols.size(); ++i)
            counts[{word.symbols[i], word.symbols[i + 1]}] += word.count;
    Pair best;
    std::int64_t maximum = 0;
    for (const auto& [pair, count] : counts)
        if (count > maximum) best = pair, maximum = count;
    return best;
}

void merge_pair(const Pair& pair, Spelling& word) {
    std::vector<std::string> merged;
    for (std::size_t i = 0; i < word.symbols.size(); ++i) {
        const bool here = i + 1 < word.symbols.size() && word.symbols[i] == pair.first &&
                          word.symbols[i + 1] == pair.second;
        merged.push_back(here ? pair.first + pair.second : word.symbols[i]);
        i += here;
    }
    word.symbols = std::move(merged);
}

}  // namespace

ClipTokenizer train_tokenizer(const std::vector<WordCount>& words, int max_length) {
    std::vector<Spelling> spellings;
    for (const WordCount& word : words) {
        ITEM3D_CHECK(!word.word.empty(), "an empty word has no token");
        Spelling spelling{{}, word.count};
        for (const char letter : word.word)
            spelling.symbols.emplace_back(1, letter);
        spelling.symbols.back() += "</w>";
        spellings.push_back(std::move(spelling));
    }
    // The base symbols are in CLIP's order, with printable bytes first.
    const auto& bytes = byte_symbols();
    std::vector<std::string> tokens;
    for (const bool first : {true, false})
        for (int byte = 0; byte < 256; ++byte)
            if (printable(byte) == first) tokens.push_back(bytes[static_cast<std::size_t>(byte)]);
    for (std::size_t i = 0; i < 256; ++i)
        tokens.push_back(tokens[i] + "</w>");
    ClipTokenizer::Merges merges;
    for (Pair pair = commonest_pair(spellings); !pair.first.empty();
         pair = commonest_pair(spellings)) {
        for (Spelling& word : spellings)
            merge_pair(pair, word);
        tokens.push_back(pair.first + pair.second);
        merges.push_back(std::move(pair));
    }
    tokens.emplace_back("<|startoftext|>");
    tokens.emplace_back("<|endoftext|>");
    ClipTokenizer::Vocabulary vocabulary;
    for (std::size_t id = 0; id < tokens.size(); ++id)
        vocabulary[tokens[id]] = static_cast<int>(id);
    ClipTokenizer::Options options;
    options.model_max_length = max_length;
    return ClipTokenizer(std::move(vocabulary), std::move(merges), options);
}

}  // namespace item3d
