// Tests of a prior's warnings about the words of a prompt.
#include "item3d/networks/vocabulary.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace item3d {
namespace {

using Words = std::vector<std::string>;

TEST(PriorVocabulary, NamesUnknownAndWeakWords) {
    const PriorVocabulary vocabulary(nlohmann::json::parse(R"({
            "words": ["a", "mug", "red", "golden", "gold", "striped", "orange", "steel"],
            "vocabulary": {
                "colors": [{"word": "red", "accuracy": 0.95, "base_color": [0.7, 0.02, 0.02]},
                           {"word": "orange", "accuracy": 0.9}],
                "materials": [{"word": "gold", "spellings": ["gold", "golden"], "accuracy": 0.85},
                              {"word": "steel", "accuracy": 0.7, "most_confused_with": "chrome"}],
                "patterns": [{"word": "striped", "accuracy": 0.3, "most_confused_with": "zigzag"}],
                "objects": [{"word": "mug", "accuracy": 0.2}]}})"),
                                     "test");
    EXPECT_EQ(vocabulary.unknown_words("A golden Mug"), Words{});
    EXPECT_EQ(vocabulary.unknown_words("a teapot, a teapot with ünlaut"),
              (Words{"teapot", "with", "ünlaut"}));
    EXPECT_EQ(vocabulary.weak_words("a red striped mug", false), (Words{"striped", "mug"}));
    EXPECT_EQ(vocabulary.weak_words("a red striped mug", true), Words{"striped"});
    EXPECT_TRUE(vocabulary.warning("a red mug", true).empty());
    EXPECT_NE(vocabulary.warning("a striped teapot", false).find("\"teapot\""), std::string::npos);
    EXPECT_EQ(vocabulary.warning("a striped cube", true),
              "the prior does not know \"cube\", knows \"striped\" poorly and sometimes takes "
              "\"striped\" for \"zigzag\" (item3d prior info lists its words)");
    EXPECT_EQ(
        vocabulary.warning("a steel mug", true),
        "the prior sometimes takes \"steel\" for \"chrome\" (item3d prior info lists its words)");
    ASSERT_EQ(vocabulary.words_of("colors").size(), 2u);
    EXPECT_FLOAT_EQ(vocabulary.words_of("colors")[0].base_color->x, .7f);
    EXPECT_TRUE(PriorVocabulary().warning("anything at all", true).empty());
}

TEST(PriorVocabulary, ReadsAThingThatItHasNoWordForAsAnObject) {
    const PriorVocabulary vocabulary(nlohmann::json::parse(R"({
            "words": ["a", "an", "and", "covered", "cup", "golden", "hat", "in", "moss", "mug", "object", "of",
                      "photo", "red", "shiny", "white", "with"],
            "vocabulary": {"objects": [{"word": "mug", "spellings": ["mug", "cup"], "accuracy": 0.9},
                                       {"word": "hat", "accuracy": 0.9}]}})"),
                                     "test");
    for (const auto& [prompt, reading] :
         {std::pair{"A red and white Rabbit", "a red and white object"},
          {"a rabbit", "an object"},
          {"a photo of a shiny rabbit covered in moss",
           "a photo of a shiny object covered in moss"},
          {"a rabbit with a red hat", "an object with a red hat"},
          {"a mossgrown golden rabbit", "a mossgrown golden object"},
          {"a mossgrown cup", "a mossgrown cup"},
          {"a Golden mug, with a zipper", "a Golden mug, with a zipper"},
          {"a golden object", "a golden object"},
          {"a rabbit wearing a hat", "an object wearing a hat"}})
        EXPECT_EQ(vocabulary.reading(prompt), reading);
    EXPECT_EQ(
        vocabulary.warning("a furry rabbit", true),
        "the prior reads \"rabbit\" as \"object\" and does not know \"furry\" (item3d prior info "
        "lists its words)");
    EXPECT_EQ(PriorVocabulary().reading("a rabbit"), "a rabbit");
}

}  // namespace
}  // namespace item3d
