#include "item3d/text/clip_tokenizer.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/text/normalization.h"
#include "item3d/text/tokenizer_json.h"

#include <algorithm>

namespace item3d {
namespace {

const std::string word_end = "</w>";

nlohmann::json special_json(const SpecialToken& token) {
    if (!token.normalized) return token.content;
    return {{"__type", "AddedToken"}, {"content", token.content}, {"lstrip", false},
            {"normalized", true},     {"rstrip", false},          {"single_word", false}};
}

}  // namespace

ClipTokenizer::ClipTokenizer(Vocabulary vocabulary, Merges merges, const Options& options,
                             const std::string& subject)
    : ClipTokenizer(BytePairs(std::move(vocabulary), std::move(merges), word_end, subject), options,
                    subject) {}

ClipTokenizer::ClipTokenizer(BytePairs pairs, const Options& options, const std::string& subject)
    : options_(options), pairs_(std::move(pairs)) {
    if (options_.model_max_length < 2)
        throw InputError(subject, "model_max_length must leave room for the start and end tokens",
                         "download the tokenizer again");

    // The last of several entries with the same content applies. In transformers, the plain pad
    // token of Stable Diffusion 1 therefore takes `normalized` from the end token.
    std::vector<SpecialToken> specials{options_.bos, options_.eos, options_.unk, options_.pad};
    specials.insert(specials.end(), options_.additional.begin(), options_.additional.end());
    std::unordered_map<std::string, bool> normalized;
    for (const SpecialToken& token : specials)
        normalized[token.content] = token.normalized;
    for (const auto& [content, after] : normalized) {
        if (content.empty())
            throw InputError(subject, "a special token is empty", "download the tokenizer again");
        const int id = pairs_.id_of(content);
        if (id < 0)
            throw InputError(subject, fmt::format("the vocabulary lacks the token '{}'", content),
                             "get the tokenizer's folder again");
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
        options.bos = read_special_token(config, "bos_token", options.bos);
        options.eos = read_special_token(config, "eos_token", options.eos);
        options.unk = read_special_token(config, "unk_token", options.unk);
        options.pad = read_special_token(config, "pad_token", options.pad);
        if (config.has("model_max_length") && config.number("model_max_length", 0) < 1e5)
            options.model_max_length = config.size("model_max_length", 77);
        for (const auto& [id, token] : read_added_tokens(config))
            options.additional.push_back(token);
    }
    if (const auto file = TokenizerJson::read(vocabulary_folder, "vocab.json", "BPE")) {
        for (const auto& [id, token] : file->added_tokens())
            options.additional.push_back(token);
    }
    return ClipTokenizer(BytePairs::load(vocabulary_folder, word_end), options,
                         (vocabulary_folder / "vocab.json").string());
}

void ClipTokenizer::save(const std::filesystem::path& folder) const {
    make_output_folder(folder);
    pairs_.save(folder);
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
    ITEM3D_CHECK(wanted >= 2, "the length must allow the start and end tokens");
    std::vector<int> ids = encode(text);
    if (ids.size() > wanted) {
        ids.resize(wanted);
        ids.back() = eos_id();
    }
    ids.resize(wanted, pad_id());
    return ids;
}

std::string ClipTokenizer::lost_words(const std::string& text, int length) const {
    const std::vector<int> ids = encode(text);
    const std::size_t maximum = length > 0 ? length : options_.model_max_length;
    if (ids.size() <= maximum) return {};
    return decode({ids.begin() + static_cast<std::ptrdiff_t>(maximum) - 1, ids.end()});
}

at::Tensor ClipTokenizer::encode_batch(const std::vector<std::string>& texts, int length) const {
    const std::int64_t columns = length > 0 ? length : options_.model_max_length;
    at::Tensor result = at::empty({static_cast<std::int64_t>(texts.size()), columns}, at::kLong);
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
    ITEM3D_CHECK(count >= 1, "a placeholder must stand for at least one id");
    if (strip_white_space(token).empty())
        throw InputError(subject, "its token is blank", "give a token, as in FILE:TOKEN");
    std::vector<std::string> names{token};
    for (int i = 1; i < count; ++i)
        names.push_back(fmt::format("{}_{}", token, i));
    const auto is_taken = [&](const std::string& name) {
        const std::string normalized = normalize_for_clip(name);
        return pairs_.id_of(name) >= 0 ||
               std::any_of(normalized_specials_.begin(), normalized_specials_.end(),
                           [&](const auto& special) { return special.first == normalized; });
    };
    for (const std::string& name : names)
        if (is_taken(name))
            throw InputError(subject, fmt::format("the tokenizer already has a token '{}'", name),
                             "give another token, as in FILE:TOKEN");
    const int first = pairs_.largest_id() + 1;
    for (const std::string& name : names)
        normalized_specials_.emplace_back(normalize_for_clip(name), pairs_.add_token(name));
    placeholder_lengths_[first] = count;
    return first;
}

std::vector<std::string> ClipTokenizer::split_words(const std::string& text) {
    return split_for_clip(normalize_for_clip(text));
}

void ClipTokenizer::append_plain(const std::string& text, std::vector<int>& ids) const {
    for (const std::string& word : split_for_clip(text))
        pairs_.append_word(word, unk_id(), ids);
}

std::string ClipTokenizer::decode(const std::vector<int>& ids, bool skip_special_tokens) const {
    std::string bytes;
    for (const int id : ids) {
        const std::string* token = pairs_.token_of(id);
        if (!token) continue;
        const auto is_it = [&](const auto& special) { return special.second == id; };
        const bool special =
            std::any_of(raw_specials_.begin(), raw_specials_.end(), is_it) ||
            std::any_of(normalized_specials_.begin(), normalized_specials_.end(), is_it);
        if (special && skip_special_tokens) continue;
        bytes += special ? *token : bytes_of_symbols(*token);
    }
    std::string text = to_valid_utf8(bytes);
    for (std::size_t at = 0; (at = text.find(word_end, at)) != std::string::npos; ++at)
        text.replace(at, word_end.size(), " ");
    return strip_white_space(text);
}

void warn_of_lost_words(const ClipTokenizer& tokenizer, const std::string& subject,
                        const std::string& text, int length) {
    const std::string lost = tokenizer.lost_words(text, length);
    if (!lost.empty())
        warn(
            fmt::format("{}: the text is longer than the limit of {} tokens, including start and "
                        "end; ignored: \"{}\"",
                        subject, length > 0 ? length : tokenizer.model_max_length(), lost));
}

}  // namespace item3d
