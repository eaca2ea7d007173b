// Words, captions and tokens.
#include "item3d/prior/captions.h"
#include "item3d/prior/lights.h"
#include "item3d/prior/tokenizer_training.h"
#include "item3d/prior/vocabulary.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <set>

namespace item3d {
namespace {

TEST(PriorCaptions, ArticlesFitTheirNouns) {
    EXPECT_EQ(mend_articles("a orange apple"), "an orange apple");
    EXPECT_EQ(mend_articles("a photo of a icy mug"), "a photo of an icy mug");
    EXPECT_EQ(mend_articles("an red mug with a red and a blue"), "a red mug with a red and a blue");
    EXPECT_EQ(mend_articles(""), "");
}

TEST(PriorCaptions, PhrasesHoldTheNounAndTheLight) {
    int with_light = 0, objects = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
        Random random(3, i);
        const std::string caption = make_caption(random, {"mug"}, {"wooden {o}"}, {" at night"});
        EXPECT_EQ(caption.find('{'), std::string::npos);
        const bool object = caption.find("object") != std::string::npos;
        EXPECT_TRUE(object || caption.find("mug") != std::string::npos) << caption;
        objects += object;
        with_light += caption.find("at night") != std::string::npos;
    }
    EXPECT_NEAR(objects, 48, 25);
    EXPECT_NEAR(with_light, 340, 30);
}

TEST(PriorCaptions, EveryMaterialSaysWhatItIs) {
    for (const std::string& kind : material_kinds()) {
        Random random(4, 2);
        const ProceduralMaterial material = make_material(random, {kind, "", ""});
        EXPECT_EQ(material.kind, kind);
        EXPECT_FALSE(material.phrases.empty());
        for (const std::string& phrase : material.phrases)
            EXPECT_NE(phrase.find("{o}"), std::string::npos) << phrase;
        for (int i = 0; i < 200; ++i) {
            const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
            const Vec3 n = glm::normalize(Vec3{random.normal(), random.normal(), random.normal()});
            const MaterialValue value = material.at(p, n);
            for (int c = 0; c < 3; ++c) {
                EXPECT_GE(value.base_color[c], 0) << kind;
                EXPECT_LE(value.base_color[c], 1) << kind;
            }
            EXPECT_GE(value.roughness, 0) << kind;
            EXPECT_LE(value.roughness, 1) << kind;
            EXPECT_GE(value.metallic, 0) << kind;
            EXPECT_LE(value.metallic, 1) << kind;
        }
    }
}

TEST(PriorTokenizer, EveryWordIsOneTokenAndCaptionsFit) {
    const std::vector<WordCount> words = caption_vocabulary(2, 20000);
    EXPECT_GT(words.size(), 90u);
    const ClipTokenizer tokenizer = train_tokenizer(words, 20);
    std::set<int> ids;
    for (const WordCount& word : words) {
        const std::vector<int> encoded = tokenizer.encode(word.word);
        ASSERT_EQ(encoded.size(), 3u) << word.word;
        EXPECT_EQ(encoded.front(), tokenizer.bos_id());
        EXPECT_EQ(encoded.back(), tokenizer.eos_id());
        EXPECT_TRUE(ids.insert(encoded[1]).second) << word.word;
    }
    EXPECT_GT(tokenizer.encode("xylophone").size(), 3u);
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Random random(8, i);
        const ProceduralMaterial material = make_material(random);
        const std::string caption =
            make_caption(random, {"snowman"}, material.phrases, {" on an overcast day"});
        EXPECT_LE(tokenizer.encode(caption).size(), 20u) << caption;
    }
}

TEST(PriorTokenizer, SavedFilesGiveTheSameTokens) {
    const ClipTokenizer tokenizer =
        train_tokenizer({{"red", 5}, {"blue", 3}, {"mug", 9}, {"3", 1}, {"d", 1}}, 12);
    const auto folder =
        std::filesystem::temp_directory_path() / ("item3d_tokenizer_" + std::to_string(::getpid()));
    tokenizer.save(folder);
    const ClipTokenizer loaded = ClipTokenizer::load(folder);
    std::filesystem::remove_all(folder);
    EXPECT_EQ(loaded.model_max_length(), 12);
    for (const char* text : {"a red mug", "3d blue mug", "", "unknown words"})
        EXPECT_EQ(loaded.encode_padded(text), tokenizer.encode_padded(text));
}

TEST(PriorVocabulary, NamesUnknownAndWeakWords) {
    const PriorVocabulary vocabulary(nlohmann::json::parse(R"({
            "words": ["a", "mug", "red", "golden", "gold", "striped", "orange"],
            "vocabulary": {
                "colors": [{"word": "red", "accuracy": 0.95, "base_color": [0.7, 0.02, 0.02]},
                           {"word": "orange", "accuracy": 0.9}],
                "materials": [{"word": "gold", "spellings": ["gold", "golden"], "accuracy": 0.85}],
                "patterns": [{"word": "striped", "accuracy": 0.3}],
                "objects": [{"word": "mug", "accuracy": 0.2}]}})"),
                                     "test");
    using Words = std::vector<std::string>;
    EXPECT_EQ(vocabulary.unknown_words("A golden Mug"), Words{});
    EXPECT_EQ(vocabulary.unknown_words("a teapot, a teapot with ünlaut"),
              (Words{"teapot", "with", "ünlaut"}));
    EXPECT_EQ(vocabulary.weak_words("a red striped mug", false), (Words{"striped", "mug"}));
    EXPECT_EQ(vocabulary.weak_words("a red striped mug", true), Words{"striped"});
    EXPECT_TRUE(vocabulary.warning("a red mug", true).empty());
    EXPECT_NE(vocabulary.warning("a striped teapot", false).find("\"teapot\""), std::string::npos);
    ASSERT_EQ(vocabulary.words_of("colors").size(), 2u);
    EXPECT_FLOAT_EQ(vocabulary.words_of("colors")[0].base_color->x, .7f);
    EXPECT_TRUE(PriorVocabulary().warning("anything at all", true).empty());
}

}  // namespace
}  // namespace item3d
