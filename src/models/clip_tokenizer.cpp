#include "item3d/models/clip_tokenizer.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/models/text_normalization.h"

#include <algorithm>
#include <queue>
#include <sstream>

namespace item3d {
namespace {

const std::string word_end = "</w>";

std::uint64_t pair_key(int left, int right) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(left)) << 32 |
           static_cast<std::uint32_t>(right);
}

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

/// A special token is a plain string or an AddedToken object.
SpecialToken read_special(const Config& config, const std::string& key,
                          const SpecialToken& fallback) {
    if (!config.has(key)) return fallback;
    const auto& value = config.json().at(key);
    if (value.is_string()) return {value.get<std::string>(), false};
    const Config token(value, config.subject() + ": " + key);
    for (const char* flag : {"lstrip", "rstrip", "single_word"})
        token.expect(flag, false);
    if (!token.has("content")) token.fail("content", "a string");
    return {token.text("content", ""), token.boolean("normalized", false)};
}

nlohmann::json special_json(const SpecialToken& token) {
    if (!token.normalized) return token.content;
    return {{"__type", "AddedToken"}, {"content", token.content}, {"lstrip", false},
            {"normalized", true},     {"rstrip", false},          {"single_word", false}};
}

ClipTokenizer::Vocabulary read_vocabulary(const std::filesystem::path& path) {
    const Config config = Config::read(path);
    ClipTokenizer::Vocabulary vocabulary;
    for (const auto& [token, id] : config.json().items()) {
        if (!id.is_number_integer() || id.get<double>() < 0 ||
            id.get<double>() > Config::max_integer)
            config.fail(token, "an id");
        vocabulary[token] = id.get<int>();
    }
    return vocabulary;
}

ClipTokenizer::Merges read_merges(const std::filesystem::path& path) {
    ClipTokenizer::Merges merges;
    std::istringstream lines(read_text(path));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line.starts_with("#version")) continue;
        const std::size_t space = line.find(' ');
        if (space == std::string::npos || space == 0 || space + 1 == line.size() ||
            line.find(' ', space + 1) != std::string::npos)
            throw InputError(
                path.string(),
                fmt::format("line {}: expected two symbols and a space between", number));
        merges.emplace_back(line.substr(0, space), line.substr(space + 1));
    }
    return merges;
}

}  // namespace

ClipTokenizer::ClipTokenizer(Vocabulary vocabulary, Merges merges, const Options& options,
                             const std::string& subject)
    : options_(options), id_of_(std::move(vocabulary)), merge_list_(std::move(merges)) {
    for (const auto& [token, id] : id_of_) {
        if (!token_of_.emplace(id, token).second)
            throw InputError(subject, fmt::format("two tokens have id {}", id));
        largest_id_ = std::max(largest_id_, id);
    }
    const auto need = [&](const std::string& token) {
        const auto found = id_of_.find(token);
        if (found == id_of_.end())
            throw InputError(subject, fmt::format("token '{}' is missing", token));
        return found->second;
    };
    for (std::size_t rank = 0; rank < merge_list_.size(); ++rank) {
        const auto& [left, right] = merge_list_[rank];
        merges_.try_emplace(pair_key(need(left), need(right)),
                            Merge{static_cast<std::int64_t>(rank), need(left + right)});
    }
    if (options_.model_max_length < 2)
        throw InputError(subject, "model_max_length must leave room for the start and end tokens");

    // The last entry with the same content decides (transformers: the plain pad token of Stable
    // Diffusion 1 takes `normalized` from the end token).
    std::vector<SpecialToken> specials{options_.bos, options_.eos, options_.unk, options_.pad};
    specials.insert(specials.end(), options_.additional.begin(), options_.additional.end());
    std::unordered_map<std::string, bool> normalized;
    for (const SpecialToken& token : specials)
        normalized[token.content] = token.normalized;
    for (const auto& [content, after] : normalized) {
        if (content.empty()) throw InputError(subject, "a special token is empty");
        const int id = need(content);
        if (after)
            normalized_specials_.emplace_back(normalize_for_clip(content), id);
        else
            raw_specials_.emplace_back(content, id);
    }
}

ClipTokenizer ClipTokenizer::load(const std::filesystem::path& folder) {
    return load(folder, folder);
}

ClipTokenizer ClipTokenizer::load(const std::filesystem::path& folder,
                                  const std::filesystem::path& vocabulary_folder) {
    Options options;
    for (const char* name : {"special_tokens_map.json", "tokenizer_config.json"}) {
        if (!std::filesystem::exists(folder / name)) continue;
        const Config config = Config::read(folder / name);
        options.bos = read_special(config, "bos_token", options.bos);
        options.eos = read_special(config, "eos_token", options.eos);
        options.unk = read_special(config, "unk_token", options.unk);
        options.pad = read_special(config, "pad_token", options.pad);
        if (config.has("model_max_length") && config.number("model_max_length", 0) < 1e5)
            options.model_max_length = config.size("model_max_length", 77);
        if (config.has("added_tokens_decoder")) {  // newer files list all of them, by id
            const Config added(config.json().at("added_tokens_decoder"),
                               config.subject() + ": added_tokens_decoder");
            for (const auto& [id, token] : added.json().items())
                options.additional.push_back(read_special(added, id, {}));
        }
    }
    return ClipTokenizer(read_vocabulary(vocabulary_folder / "vocab.json"),
                         read_merges(vocabulary_folder / "merges.txt"), options,
                         (vocabulary_folder / "vocab.json").string());
}

void ClipTokenizer::save(const std::filesystem::path& folder) const {
    std::vector<std::pair<int, std::string>> tokens(token_of_.begin(), token_of_.end());
    std::sort(tokens.begin(), tokens.end());
    make_output_folder(folder);
    nlohmann::ordered_json vocabulary = nlohmann::ordered_json::object();
    for (const auto& [id, token] : tokens)
        vocabulary[token] = id;
    write_atomically(folder / "vocab.json", vocabulary.dump());

    std::string merges = "#version: 0.2\n";
    for (const auto& [left, right] : merge_list_)
        merges += left + " " + right + "\n";
    write_atomically(folder / "merges.txt", merges);

    const nlohmann::json specials = {{"bos_token", special_json(options_.bos)},
                                     {"eos_token", special_json(options_.eos)},
                                     {"pad_token", special_json(options_.pad)},
                                     {"unk_token", special_json(options_.unk)}};
    write_atomically(folder / "special_tokens_map.json", specials.dump(1) + "\n");
    nlohmann::json config = specials;
    config["add_prefix_space"] = false;
    config["do_lower_case"] = true;
    config["errors"] = "replace";
    config["model_max_length"] = options_.model_max_length;
    config["tokenizer_class"] = "CLIPTokenizer";
    write_atomically(folder / "tokenizer_config.json", config.dump(1) + "\n");
}

std::vector<int> ClipTokenizer::encode(const std::string& text) const {
    std::vector<int> ids{bos_id()};
    const auto special = [&](int id) {
        const auto found = placeholder_lengths_.find(id);
        const int count = found == placeholder_lengths_.end() ? 1 : found->second;
        for (int i = 0; i < count; ++i)
            ids.push_back(id + i);
    };
    cut_at_specials(
        text, raw_specials_,
        [&](const std::string& piece) {
            cut_at_specials(
                normalize_for_clip(piece), normalized_specials_,
                [&](const std::string& plain) { append_plain(plain, ids); }, special);
        },
        special);
    ids.push_back(eos_id());
    return ids;
}

std::vector<int> ClipTokenizer::encode_padded(const std::string& text, int length) const {
    const std::size_t wanted = length > 0 ? length : options_.model_max_length;
    ITEM3D_CHECK(wanted >= 2, "there must be room for the start and end tokens");
    std::vector<int> ids = encode(text);
    if (ids.size() > wanted) {
        ids.resize(wanted);
        ids.back() = eos_id();
    }
    ids.resize(wanted, pad_id());
    return ids;
}

torch::Tensor ClipTokenizer::encode_batch(const std::vector<std::string>& texts, int length) const {
    const std::int64_t columns = length > 0 ? length : options_.model_max_length;
    torch::Tensor result =
        torch::empty({static_cast<std::int64_t>(texts.size()), columns}, torch::kInt64);
    auto rows = result.accessor<std::int64_t, 2>();
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const std::vector<int> ids = encode_padded(texts[i], length);
        for (std::size_t j = 0; j < ids.size(); ++j)
            rows[i][j] = ids[j];
    }
    return result;
}

int ClipTokenizer::add_placeholder(const std::string& token, int count,
                                   const std::string& subject) {
    ITEM3D_CHECK(count >= 1, "a placeholder stands for one id at least");
    if (strip_white_space(token).empty())
        throw InputError(subject, "its token is blank", "give it one, as FILE:TOKEN");
    std::vector<std::string> names{token};
    for (int i = 1; i < count; ++i)
        names.push_back(fmt::format("{}_{}", token, i));
    const auto is_taken = [&](const std::string& name) {
        const std::string normalized = normalize_for_clip(name);
        return id_of_.count(name) > 0 ||
               std::any_of(normalized_specials_.begin(), normalized_specials_.end(),
                           [&](const auto& special) { return special.first == normalized; });
    };
    for (const std::string& name : names)
        if (is_taken(name))
            throw InputError(subject, fmt::format("the tokenizer has a token '{}' already", name),
                             "give it another, as FILE:TOKEN");
    const int first = largest_id_ + 1;
    for (const std::string& name : names) {
        ++largest_id_;
        id_of_[name] = largest_id_;
        token_of_[largest_id_] = name;
        normalized_specials_.emplace_back(normalize_for_clip(name), largest_id_);
    }
    placeholder_lengths_[first] = count;
    return first;
}

std::vector<std::string> ClipTokenizer::split_words(const std::string& text) {
    return split_for_clip(normalize_for_clip(text));
}

void ClipTokenizer::append_plain(const std::string& text, std::vector<int>& ids) const {
    for (const std::string& word : split_for_clip(text))
        append_word(word, ids);
}

void ClipTokenizer::append_word(const std::string& bytes, std::vector<int>& ids) const {
    // A doubly linked list of symbols and a queue of the merges that its neighbours allow: linear
    // in the word's length but for a logarithm, because prompts may be hostile.
    struct Symbol {
        int id;
        int previous, next;
        bool gone = false;
    };
    struct Candidate {
        std::int64_t rank;
        int at, id;
        bool operator<(const Candidate& other) const {  // the queue's top is its largest
            return std::pair(rank, at) > std::pair(other.rank, other.at);
        }
    };
    std::vector<Symbol> symbols;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string symbol = byte_symbols()[static_cast<std::uint8_t>(bytes[i])];
        if (i + 1 == bytes.size()) symbol += word_end;
        const auto found = id_of_.find(symbol);
        const int at = static_cast<int>(i);
        symbols.push_back({found == id_of_.end() ? unk_id() : found->second, at - 1,
                           i + 1 == bytes.size() ? -1 : at + 1});
    }

    const auto merge_at = [&](int at) -> const Merge* {
        if (at < 0 || symbols[at].next < 0) return nullptr;
        const auto found = merges_.find(pair_key(symbols[at].id, symbols[symbols[at].next].id));
        return found == merges_.end() ? nullptr : &found->second;
    };
    std::priority_queue<Candidate> queue;
    const auto consider = [&](int at) {
        if (const Merge* merge = merge_at(at)) queue.push({merge->rank, at, merge->id});
    };
    for (int i = 0; i < static_cast<int>(symbols.size()); ++i)
        consider(i);
    while (!queue.empty()) {
        const Candidate top = queue.top();
        queue.pop();
        if (symbols[top.at].gone) continue;
        const Merge* merge = merge_at(top.at);
        if (!merge || merge->id != top.id) continue;  // a neighbour was merged meanwhile
        Symbol& left = symbols[top.at];
        Symbol& right = symbols[left.next];
        left.id = merge->id;
        left.next = right.next;
        if (right.next >= 0) symbols[right.next].previous = top.at;
        right.gone = true;
        consider(left.previous);
        consider(top.at);
    }
    for (const Symbol& symbol : symbols)
        if (!symbol.gone) ids.push_back(symbol.id);
}

std::string ClipTokenizer::decode(const std::vector<int>& ids, bool skip_special_tokens) const {
    std::string bytes;
    for (const int id : ids) {
        const auto found = token_of_.find(id);
        if (found == token_of_.end()) continue;
        const auto is_it = [&](const auto& special) { return special.second == id; };
        const bool special =
            std::any_of(raw_specials_.begin(), raw_specials_.end(), is_it) ||
            std::any_of(normalized_specials_.begin(), normalized_specials_.end(), is_it);
        if (special && skip_special_tokens) continue;
        bytes += special ? found->second : bytes_of_symbols(found->second);
    }
    std::string text = to_valid_utf8(bytes);
    for (std::size_t at = 0; (at = text.find(word_end, at)) != std::string::npos; ++at)
        text.replace(at, word_end.size(), " ");
    return strip_white_space(text);
}

int ClipTokenizer::id_of(const std::string& token) const {
    const auto found = id_of_.find(token);
    return found == id_of_.end() ? -1 : found->second;
}

}  // namespace item3d
