#include "item3d/studio/about.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/version.h"
#include "item3d/hub/find_prior.h"
#include "item3d/lighting/environment.h"
#include "item3d/studio/studio.h"

#include <sys/sysinfo.h>

#include <thread>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Returns prompt words by kind, with the prior's accuracies. The member "all" has every word of
/// the prior's training captions.
Json words_of(const Json& prior) {
    Json words = Json::object();
    words["all"] = prior.value("words", Json::array());
    words["parts"] = Json::array();  // parts that the segmenter knows
    if (const Json::json_pointer names("/segmenter/parts/names"); prior.contains(names))
        for (const auto& [part, iou] : prior.at(names).items())
            words["parts"].push_back(part);
    const Json vocabulary = prior.value("vocabulary", Json::object());
    for (const auto& [kind, entries] : vocabulary.items()) {
        words[kind] = Json::array();
        for (const Json& entry : entries)
            words[kind].push_back({{"word", entry.value("word", "")},
                                   {"caption", entry.value("caption", "")},
                                   {"spellings", entry.value("spellings", Json::array())},
                                   {"accuracy", entry.value("accuracy", 0.0)},
                                   {"base_color", entry.value("base_color", Json())}});
    }
    return words;
}

/// Returns the settings with the prior's values as defaults.
Json settings_of(const Json& catalogue, const Json& prior) {
    Json settings = catalogue;
    const Json defaults = prior.value("defaults", Json::object());
    for (Json& entry : settings)
        if (const auto own = defaults.find(entry.at("name").get<std::string>());
            own != defaults.end())
            entry["default"] = *own;
    return settings;
}

double memory_bytes() {
    struct sysinfo machine {};
    if (::sysinfo(&machine) != 0) return 0;
    return static_cast<double>(machine.totalram) * machine.mem_unit;
}

}  // namespace

Json about_studio(const Studio& studio) {
    const fs::path folder = find_prior("");
    const Json prior = parse_json_or_throw(read_text(folder / "prior.json"));
    return {
        {"version", version()},
        {"prior",
         {{"name", prior.value("name", "prior")}, {"resolution", prior.value("resolution", 0)}}},
        {"words", words_of(prior)},
        {"settings", settings_of(studio.commands().settings(), prior)},
        {"lights", light_preset_names()},
        {"demo", fs::exists(demo_model())},
        {"threads", std::thread::hardware_concurrency()},
        {"memory_bytes", memory_bytes()}};
}

}  // namespace item3d
