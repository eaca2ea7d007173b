#include "item3d/text/bert_tokenizer.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/text/special_tokens.h"
#include "item3d/text/tokenizer_json.h"

#include <algorithm>
#include <sstream>

namespace item3d {
namespace {

constexpr std::size_t longest_word = 100;  // in code points; longer words are unknown
const std::string continuation = "##";

}  // namespace

BertTokenizer BertTokenizer::load(const std::filesystem::path& folder) {
    std::filesystem::path path = folder / "vocab.txt";
    BertTokenizer tokenizer;
    if (const auto file = TokenizerJson::read(folder, "vocab.txt", "WordPiece")) {
        path = folder / "tokenizer.json";
        for (const auto& [token, id] : file->vocabulary()) {
            if (static_cast<std::size_t>(id) >= file->vocabulary().size())
                throw InputError(
                    path.string(),
                    fmt::format("token '{}' has id {} of {}", token, id, file->vocabulary().size()),
                    "download the tokenizer again");
            tokenizer.id_of_[token] = id;
            if (static_cast<std::size_t>(id) >= tokenizer.tokens_.size())
                tokenizer.tokens_.resize(static_cast<std::size_t>(id) + 1);
            tokenizer.tokens_[static_cast<std::size_t>(id)] = token;
        }
    } else {
        std::istringstream lines(read_text(path));
        for (std::string line; std::getline(lines, line);) {
            if (!line.empty() && line.back() == '\r') line.pop_back();
            tokenizer.id_of_[line] = static_cast<int>(tokenizer.tokens_.size());
            tokenizer.tokens_.push_back(line);
        }
    }

    const std::filesystem::path config_path = folder / "tokenizer_config.json";
    const Config config = std::filesystem::exists(config_path)
                              ? Config::read(config_path)
                              : Config(nlohmann::json::object(), config_path.string());
    BertNormalization& normalization = tokenizer.normalization_;
    normalization.lower_case = config.boolean("do_lower_case", true);
    normalization.strip_accents = config.boolean("strip_accents", normalization.lower_case);
    normalization.separate_ideographs = config.boolean("tokenize_chinese_chars", true);
    const auto special = [&](const char* key, const char* fallback) {
        const std::string content = read_special_token(config, key, {fallback}).content;
        const auto found = tokenizer.id_of_.find(content);
        if (found == tokenizer.id_of_.end())
            throw InputError(path.string(), fmt::format("token '{}' is missing", content),
                             "download the tokenizer again");
        tokenizer.specials_.emplace_back(content, found->second);
        return found->second;
    };
    tokenizer.unknown_ = special("unk_token", "[UNK]");
    tokenizer.begin_ = special("cls_token", "[CLS]");
    tokenizer.end_ = special("sep_token", "[SEP]");
    special("pad_token", "[PAD]");
    special("mask_token", "[MASK]");
    return tokenizer;
}

std::vector<int> BertTokenizer::encode(const std::string& text) const {
    std::vector<int> ids{begin_};
    cut_at_specials(
        to_valid_utf8(text), specials_,
        [&](const std::string& plain) {
            for (const std::string& word :
                 split_for_bert(normalize_for_bert(plain, normalization_)))
                append_word(word, ids);
        },
        [&](int id) { ids.push_back(id); });
    ids.push_back(end_);
    return ids;
}

/// Appends the longest token at the start of the word, then the longest token at the start of the
/// rest, and so on.
void BertTokenizer::append_word(const std::string& word, std::vector<int>& ids) const {
    const std::vector<std::string> symbols = code_points(word);
    std::vector<int> pieces;
    for (std::size_t begin = 0; begin < symbols.size() && symbols.size() <= longest_word;) {
        std::string piece = begin > 0 ? continuation : "";
        int longest = -1;
        std::size_t next = begin;
        for (std::size_t end = begin; end < symbols.size(); ++end) {
            piece += symbols[end];
            const auto found = id_of_.find(piece);
            if (found == id_of_.end()) continue;
            longest = found->second;
            next = end + 1;
        }
        if (longest < 0) {
            pieces.clear();
            break;
        }
        pieces.push_back(longest);
        begin = next;
    }
    if (pieces.empty()) pieces = {unknown_};
    ids.insert(ids.end(), pieces.begin(), pieces.end());
}

std::string BertTokenizer::decode(const std::vector<int>& ids) const {
    std::string text;
    for (const int id : ids) {
        if (id < 0 || id > largest_id()) continue;
        const std::string& token = tokens_[static_cast<std::size_t>(id)];
        const auto is_it = [&](const auto& special) { return special.second == id; };
        if (std::any_of(specials_.begin(), specials_.end(), is_it)) continue;
        const bool closes = token == "." || token == "?" || token == "!" || token == ",";
        if (text.empty() || closes)
            text += token;
        else if (token.starts_with(continuation))
            text += token.substr(continuation.size());
        else
            text += " " + token;
    }
    return text;
}

}  // namespace item3d
