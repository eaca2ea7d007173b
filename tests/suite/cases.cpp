// Tests of the edits that the suite makes, and of the summary of their results.
#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/suite/edit_suite.h"
#include "item3d/suite/held_out_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace item3d {
namespace {

const std::vector<std::string> six_nouns{"chair", "cow", "duck", "lamp", "mug", "object"};

TEST(PriorSuite, HasTenEditsOfEachMeshInThePriorsOwnWords) {
    const PriorVocabulary vocabulary =
        PriorVocabulary::load(std::filesystem::path(ITEM3D_TEST_DATA) / "../../assets/prior");
    const std::vector<SuiteCase> cases = prior_suite_cases(six_nouns, vocabulary);
    ASSERT_EQ(cases.size(), 60u);
    std::map<std::string, std::set<std::string>> words;
    for (const SuiteCase& test : cases) {
        words[test.group].insert(test.word);
        const std::string from = prompt_of(test.source, test.mesh);
        const std::string to = prompt_of(test.target, test.mesh);
        EXPECT_NE(from, to);
        EXPECT_NE(to.find(test.mesh), std::string::npos) << to;
        EXPECT_EQ(vocabulary.unknown_words(from + " " + to), std::vector<std::string>{}) << to;
    }
    // Each word is used once before any word repeats.
    const auto materials = vocabulary.words_of("materials");
    const auto metals = static_cast<std::size_t>(
        std::count_if(materials.begin(), materials.end(),
                      [](const KnownWord& word) { return word.base_color.has_value(); }));
    EXPECT_EQ(words["colors"].size(),
              std::min<std::size_t>(24, vocabulary.words_of("colors").size()));
    EXPECT_EQ(words["metals"].size(), std::min<std::size_t>(12, metals));
    EXPECT_EQ(words["materials"].size(), std::min<std::size_t>(12, materials.size() - metals));
    EXPECT_EQ(words["patterns"].size(),
              std::min<std::size_t>(12, vocabulary.words_of("patterns").size()));
}

TEST(PriorSuite, APriorWithoutColorsIsRefused) {
    const PriorVocabulary bare(nlohmann::json::object(), "prior.json");
    EXPECT_THROW(prior_suite_cases(six_nouns, bare), InputError);
}

TEST(PriorSuite, TotalsCountWhatIsRight) {
    const auto result = [](const char* group, double seconds) {
        return nlohmann::json{{"group", group},
                              {"scores", {{"detail_kept", .5}}},
                              {"seconds", seconds},
                              {"peak_memory_bytes", 1e9 * seconds}};
    };
    std::vector<nlohmann::json> results{result("colors", 1), result("colors", 3),
                                        result("stripes", 2)};
    results[0]["right"] = true;
    results[1]["right"] = false;
    const nlohmann::json totals = suite_totals(results);
    EXPECT_EQ(totals["groups"]["colors"]["edits"], 2);
    EXPECT_EQ(totals["groups"]["colors"]["right"], 1);
    EXPECT_DOUBLE_EQ(totals["groups"]["colors"]["seconds"].get<double>(), 2);
    EXPECT_DOUBLE_EQ(totals["groups"]["colors"]["seconds_most"].get<double>(), 3);
    EXPECT_FALSE(totals["groups"]["stripes"].contains("right"));
    EXPECT_DOUBLE_EQ(totals["peak_memory_bytes"].get<double>(), 3e9);
}

TEST(PriorSuite, HeldOutMeshesFillTheUnitSphere) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "held_out_meshes";
    const auto files = save_held_out_meshes(folder);
    EXPECT_EQ(files.size(), 6u);
    for (const auto& [noun, file] : files) {
        const Model model = load_model(file);
        EXPECT_GT(model.triangle_count(), 2000u) << noun;
        float farthest = 0;
        for (const Vec3& position : model.primitives.at(0).positions)
            farthest = std::max(farthest, glm::length(position));
        EXPECT_NEAR(farthest, 1, 1e-4) << noun;
    }
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace item3d
