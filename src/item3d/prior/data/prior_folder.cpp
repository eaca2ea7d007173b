#include "item3d/prior/data/prior_folder.h"

#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/prior/data/captions.h"

namespace item3d {

nlohmann::json read_prior_json(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "prior.json";
    if (!std::filesystem::exists(file)) return nlohmann::json::object();
    nlohmann::json prior = parse_json(read_text(file));
    return prior.is_object() ? prior : nlohmann::json::object();
}

nlohmann::json update_prior_json(const std::filesystem::path& folder,
                                 const nlohmann::json& members) {
    nlohmann::json prior = read_prior_json(folder);
    prior.update(members);
    write_atomically(folder / "prior.json", prior.dump(2) + "\n");
    return prior;
}

std::set<std::string> trained_words(const std::filesystem::path& folder,
                                    const ClipTokenizer& tokenizer) {
    auto words = read_prior_json(folder).value("words", std::set<std::string>{});
    if (!words.empty()) return words;
    for (const WordCount& word : caption_vocabulary(1))
        if (tokenizer.encode(word.word).size() == 3) words.insert(word.word);
    return words;
}

}  // namespace item3d
