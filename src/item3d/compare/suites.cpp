#include "item3d/compare/suites.h"

#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/names.h"
#include "item3d/hub/find_prior.h"
#include "item3d/io/load.h"
#include "item3d/io/save.h"
#include "item3d/networks/vocabulary.h"
#include "item3d/suite/cases.h"
#include "item3d/suite/held_out_meshes.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Meshes = std::map<std::string, fs::path>;

CompareMethod own_method(const std::string& name, Json options) {
    return {name, std::move(options)};
}

/// Returns a method that uses the guidance alone, without the edit's additions.
CompareMethod bare_guidance(const std::string& name, const Json& options, double cost, int rows) {
    Json all = {
        {"iterations", std::max(1L, std::lround(rows / cost))}, {"settle", 0}, {"detail", "off"}};
    all.update(options);
    return {name, all};
}

/// Returns all guidance methods, each with as many steps as `rows` evaluations of the U-Net allow.
/// The cost of a step is the number of forward evaluations for each image; backward passes do not
/// count.
std::vector<CompareMethod> guidance_contenders(int rows) {
    const auto contender = [&](const char* name, double cost) {
        return bare_guidance(name, {{"guidance", name}}, cost, rows);
    };
    const auto adjusted = [&](const char* adjust, double cost) {
        return bare_guidance(adjust, {{"guidance", "rdl"}, {"adjust", adjust}}, cost, rows);
    };
    return {contender("sds", 2),
            adjusted("learned", 1 + 4),  // 1 for the target, 4 for the source's samples
            adjusted("off", 2), adjusted("caption", 2), adjusted("caption-paper", 2),
            contender("dds", 4), contender("csd", 3), contender("nfsd", 3), contender("pds", 4),
            // ism inverts from noise level 0 upwards in steps of a fifth of the schedule, and then
            // needs three evaluations.
            contender("ism", 4.7),
            // sdi inverts in steps of a tenth of the schedule, with two evaluations each, to noise
            // levels that fall from 0.98 to 0.25.
            contender("sdi", 16)};
}

/// Writes the source models of the cases, each once.
class StartModels {
  public:
    explicit StartModels(const fs::path& folder)
        : folder_(folder), vocabulary_(PriorVocabulary::load(find_prior("embedded"))) {}

    /// Returns the demo's mug, or a shape held out from the prior's training, without materials.
    fs::path mesh(const std::string& noun) const {
        if (noun == "mug") return assets_folder() / "demo" / "mug.glb";
        return save_held_out_mesh(folder_ / "meshes", noun);
    }
    CompareCase start(const SuiteCase& test, const fs::path& mesh) const {
        const fs::path model = folder_ / (slug(test.source + " " + test.mesh) + ".glb");
        save_model(model, source_model(test, load_model(mesh), vocabulary_));
        CompareCase result;
        result.model = model;
        result.from = prompt_of(test.source, test.mesh);
        result.to = prompt_of(test.target, test.mesh);
        result.name = test.mesh + ": " + result.to;
        result.expect = test.word;
        return result;
    }
    /// Returns a case whose source has a plain colour. word: the target's word in the prior's
    /// vocabulary.
    CompareCase plain(const std::string& noun, const std::string& color, const std::string& look,
                      const std::string& word) const {
        return start({"colors", noun, color, look, word}, mesh(noun));
    }

  private:
    fs::path folder_;
    PriorVocabulary vocabulary_;
};

std::vector<CompareCase> default_cases(const StartModels& models) {
    std::vector<CompareCase> cases;
    for (const auto& [look, word] : {std::pair{"blue", "blue"}, std::pair{"golden", "gold"}}) {
        const std::string to = prompt_of(look, "mug");
        cases.push_back({"mug: " + to, models.mesh("mug"), "a red mug", to, word, Json::object()});
    }
    cases.push_back(models.plain("rabbit", "white", "green", "green"));
    cases.push_back(models.plain("rabbit", "white", "marble", "marble"));
    cases.push_back(models.plain("teapot", "gray", "pink", "pink"));
    cases.push_back(models.plain("teapot", "gray", "wooden", "wood"));
    return cases;
}

/// Returns three cases for each of the six held-out meshes: two of its colours and one of its
/// materials, so that no colour and no material of suite_cases() is a target twice.
std::vector<CompareCase> held_out_cases(const StartModels& models) {
    const std::vector<std::string> nouns = held_out_nouns();
    Meshes meshes;
    for (const std::string& noun : nouns)
        meshes[noun] = models.mesh(noun);
    std::vector<CompareCase> cases;
    std::map<std::string, std::size_t> seen;
    for (const SuiteCase& test : suite_cases(nouns)) {
        const bool later = std::find(nouns.begin(), nouns.end(), test.mesh) - nouns.begin() >= 3;
        if (seen[test.mesh + test.group]++ % 2 != (later ? 1 : 0)) continue;
        cases.push_back(models.start(test, meshes.at(test.mesh)));
    }
    return cases;
}

/// Returns cases of colours, materials and stripes for each mesh. thin: uses only a third of the
/// colours and half of the materials; small_textures: uses textures with 256 texels per edge, or
/// 512 for stripes.
std::vector<CompareCase> cases_of_meshes(const StartModels& models, const Meshes& meshes, bool thin,
                                         bool small_textures) {
    std::vector<std::string> nouns;
    for (const auto& [noun, file] : meshes)
        nouns.push_back(noun);
    std::vector<CompareCase> cases;
    std::map<std::string, int> seen;
    for (const SuiteCase& test : suite_cases(nouns)) {
        const int every = test.group == "colors" ? 3 : test.group == "materials" ? 2 : 1;
        if (seen[test.group]++ % every != 0 && thin) continue;
        cases.push_back(models.start(test, meshes.at(test.mesh)));
        if (small_textures)
            cases.back().options["texture-size"] = test.group == "stripes" ? 512 : 256;
    }
    return cases;
}

std::vector<CompareCase> relighting_cases(const StartModels& models) {
    std::vector<CompareCase> cases;
    for (const auto& [noun, color] : {std::pair{"mug", "red"}, std::pair{"teapot", "gray"}}) {
        const CompareCase start = models.plain(noun, color, color, "");
        for (const char* words : {"in the dark", "at sunset", "in bright light"}) {
            CompareCase test = start;
            test.to = start.from + " " + words;
            test.name = std::string(noun) + " " + words;
            cases.push_back(test);
        }
    }
    return cases;
}

}  // namespace

std::vector<CompareSuite> compare_suites(int rows) {
    const CompareMethod item3d = plain_method("item3d"), sds = plain_method("sds");
    return {
        {"methods", "every method on six edits", {}, {}},
        {"held-out", "every method on eighteen edits of six shapes", {}, {}},
        {"quality", "the default method on colours, materials and stripes", {item3d}, {}, true},
        {"direction", "the relative direction compared with SDS", {sds, item3d}, {}, true},
        {"adjustment",
         "the direction with and without adjustment, on a duck and a cow",
         {item3d, own_method("caption", {{"adjust", "caption"}}),
          own_method("caption-paper", {{"adjust", "caption-paper"}}),
          own_method("off", {{"adjust", "off"}})},
         {}},
        {"guidance",
         "every guidance method at an equal number of U-Net rows",
         guidance_contenders(rows),
         {},
         true},
        {"relighting",
         "light from words: a physical sky compared with free texels",
         {own_method("physical", {{"optimize", "light"}, {"light-model", "physical"}}),
          own_method("texels", {{"optimize", "light"}, {"light-model", "texels"}})},
         {}},
        {"lights",
         "edited models under other lights",
         {item3d, sds, plain_method("texture"), plain_method("syncmvd")},
         {{"noon", "sunset", "night"}}},
        {"2d",
         "ControlNet in 2D and CLIP: inconsistent views, or edits that do not follow the text",
         {plain_method("controlnet-2d"), plain_method("clip"), item3d},
         {{}, true}},
    };
}

std::vector<CompareCase> cases_of_suite(const CompareSuite& suite, const fs::path& folder,
                                        const Meshes& meshes) {
    make_output_folder(folder);
    const StartModels models(folder);
    if (suite.takes_meshes) {
        Meshes used = meshes;
        if (used.empty())
            for (const char* noun : {"mug", "rabbit", "teapot"})
                used[noun] = models.mesh(noun);
        return cases_of_meshes(models, used, suite.name != "quality", suite.name == "guidance");
    }
    if (suite.name == "held-out") return held_out_cases(models);
    if (suite.name == "adjustment")
        return {models.plain("duck", "yellow", "red", "red"),
                models.plain("duck", "yellow", "golden", "gold"),
                models.plain("cow", "white", "brown", "brown")};
    if (suite.name == "relighting") return relighting_cases(models);
    if (suite.name == "lights")
        return {models.plain("mug", "red", "golden", "gold"),
                models.plain("rabbit", "white", "marble", "marble"),
                models.plain("teapot", "gray", "pink", "pink")};
    if (suite.name == "2d")
        return {models.plain("truck", "yellow", "red", "red"),
                models.plain("mug", "red", "blue", "blue")};
    return default_cases(models);
}

}  // namespace item3d
