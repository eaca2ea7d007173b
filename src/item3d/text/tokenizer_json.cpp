#include "item3d/text/tokenizer_json.h"

#include <unordered_set>

namespace item3d {

std::vector<std::pair<std::string, int>> read_ids(const Config& object) {
    std::vector<std::pair<std::string, int>> ids;
    for (const auto& [token, id] : object.json().items()) {
        if (!id.is_number_integer() || id.get<double>() < 0 ||
            id.get<double>() > Config::max_integer)
            object.fail(token, "an id");
        ids.emplace_back(token, id.get<int>());
    }
    return ids;
}

TokenizerJson::TokenizerJson(Config file) : file_(std::move(file)) {
    vocabulary_ = read_ids(file_.part("model").part("vocab"));
    if (!file_.has("added_tokens")) return;
    if (!file_.json()["added_tokens"].is_array()) file_.fail("added_tokens", "a list");
    std::unordered_set<std::string> known;
    for (const auto& [token, id] : vocabulary_)
        known.insert(token);
    for (const nlohmann::json& entry : file_.json()["added_tokens"]) {
        const Config holder(nlohmann::json{{"added_tokens", entry}}, file_.subject());
        const int id = holder.part("added_tokens").integer("id", -1);
        if (id < 0) file_.fail("added_tokens", "tokens with ids");
        added_.emplace_back(id, read_special_token(holder, "added_tokens", {}));
        const std::string& content = added_.back().second.content;
        if (known.insert(content).second) vocabulary_.emplace_back(content, id);
    }
}

std::optional<TokenizerJson> TokenizerJson::read(const std::filesystem::path& folder,
                                                 const std::string& instead,
                                                 const std::string& type) {
    const std::filesystem::path path = folder / "tokenizer.json";
    if (std::filesystem::exists(folder / instead) || !std::filesystem::exists(path))
        return std::nullopt;
    Config file = Config::read(path);
    file.part("model").expect("type", type);
    return TokenizerJson(std::move(file));
}

std::vector<std::pair<std::string, std::string>> TokenizerJson::merges() const {
    const Config model = file_.part("model");
    if (!model.has("merges") || !model.json()["merges"].is_array()) model.fail("merges", "a list");
    std::vector<std::pair<std::string, std::string>> merges;
    for (const nlohmann::json& merge : model.json()["merges"]) {
        if (merge.is_array() && merge.size() == 2 && merge[0].is_string() && merge[1].is_string()) {
            merges.emplace_back(merge[0].get<std::string>(), merge[1].get<std::string>());
            continue;
        }
        const std::string text = merge.is_string() ? merge.get<std::string>() : "";
        const std::size_t space = text.find(' ');
        if (space == std::string::npos) model.fail("merges", "pairs of symbols");
        merges.emplace_back(text.substr(0, space), text.substr(space + 1));
    }
    return merges;
}

}  // namespace item3d
