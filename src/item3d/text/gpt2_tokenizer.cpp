#include "item3d/text/gpt2_tokenizer.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/text/normalization.h"
#include "item3d/text/special_tokens.h"
#include "item3d/text/tokenizer_json.h"

#include <algorithm>

namespace item3d {

Gpt2Tokenizer Gpt2Tokenizer::load(const std::filesystem::path& folder) {
    Gpt2Tokenizer tokenizer(BytePairs::load(folder, ""));
    const std::string subject = (folder / "vocab.json").string();
    if (std::filesystem::exists(folder / "added_tokens.json")) {
        const Config config = Config::read(folder / "added_tokens.json");
        for (const auto& [token, id] : config.json().items())
            if (!token.empty()) tokenizer.added_.emplace_back(token, config.integer(token, 0));
    }
    SpecialToken begin{"</s>"}, unknown{"</s>"};
    std::vector<SpecialToken> others;
    bool adds_begin = true;
    for (const char* name : {"special_tokens_map.json", "tokenizer_config.json"}) {
        if (!std::filesystem::exists(folder / name)) continue;
        const Config config = Config::read(folder / name);
        config.expect("add_prefix_space", false);
        begin = read_special_token(config, "bos_token", begin);
        unknown = read_special_token(config, "unk_token", unknown);
        for (const char* key : {"eos_token", "pad_token"})
            if (config.has(key)) others.push_back(read_special_token(config, key, {}));
        adds_begin = config.boolean("add_bos_token", adds_begin);
        for (const auto& [id, token] : read_added_tokens(config))
            if (!token.content.empty()) tokenizer.specials_.emplace_back(token.content, id);
    }
    if (const auto file = TokenizerJson::read(folder, "vocab.json", "BPE")) {
        for (const auto& [id, token] : file->added_tokens())
            if (!token.content.empty()) tokenizer.specials_.emplace_back(token.content, id);
    }
    others.insert(others.end(), {begin, unknown});
    for (const SpecialToken& token : others) {
        const int id = tokenizer.pairs_.id_of(token.content);
        if (token.content.empty() || id < 0)
            throw InputError(subject, fmt::format("token '{}' is missing", token.content),
                             "download the tokenizer again");
        tokenizer.specials_.emplace_back(token.content, id);
    }
    tokenizer.begin_ = adds_begin ? tokenizer.pairs_.id_of(begin.content) : -1;
    tokenizer.unknown_ = tokenizer.pairs_.id_of(unknown.content);
    return tokenizer;
}

int Gpt2Tokenizer::largest_id() const {
    int largest = pairs_.largest_id();
    for (const auto* tokens : {&specials_, &added_})
        for (const auto& [token, id] : *tokens)
            largest = std::max(largest, id);
    return largest;
}

std::vector<int> Gpt2Tokenizer::encode(const std::string& text) const {
    std::vector<int> ids;
    if (begin_ >= 0) ids.push_back(begin_);
    auto whole = specials_;
    whole.insert(whole.end(), added_.begin(), added_.end());
    cut_at_specials(
        to_valid_utf8(text), whole,
        [&](const std::string& plain) {
            for (const std::string& word : split_for_gpt2(plain))
                pairs_.append_word(word, unknown_, ids);
        },
        [&](int id) { ids.push_back(id); });
    return ids;
}

std::string Gpt2Tokenizer::decode(const std::vector<int>& ids) const {
    std::string bytes;
    for (const int id : ids) {
        const auto is_it = [&](const auto& special) { return special.second == id; };
        if (std::any_of(specials_.begin(), specials_.end(), is_it)) continue;
        const auto added = std::find_if(added_.begin(), added_.end(), is_it);
        if (added != added_.end())
            bytes += added->first;
        else if (const std::string* token = pairs_.token_of(id))
            bytes += bytes_of_symbols(*token);
    }
    return to_valid_utf8(bytes);
}

}  // namespace item3d
