#include "item3d/text/special_tokens.h"

#include <charconv>

namespace item3d {

SpecialToken read_special_token(const Config& config, const std::string& key,
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

std::vector<std::pair<int, SpecialToken>> read_added_tokens(const Config& config) {
    std::vector<std::pair<int, SpecialToken>> tokens;
    if (!config.has("added_tokens_decoder")) return tokens;
    const Config added(config.json().at("added_tokens_decoder"),
                       config.subject() + ": added_tokens_decoder");
    for (const auto& [key, token] : added.json().items()) {
        int id = -1;
        const char* end = key.data() + key.size();
        if (std::from_chars(key.data(), end, id).ptr != end || id < 0)
            added.fail(key, "ids as keys");
        tokens.emplace_back(id, read_special_token(added, key, {}));
    }
    return tokens;
}

}  // namespace item3d
