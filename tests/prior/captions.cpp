// Tests of words, captions and tokens.
#include "item3d/prior/data/captions.h"

#include "item3d/prior/data/lights.h"
#include "item3d/prior/data/materials/colors.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/prior/training/tokenizer_training.h"

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
        const std::string caption =
            make_caption(random, {{"mug"}, {"wooden {o}"}, {" at night"}, {}});
        EXPECT_EQ(caption.find('{'), std::string::npos);
        const bool object = caption.find("object") != std::string::npos;
        EXPECT_TRUE(object || caption.find("mug") != std::string::npos) << caption;
        objects += object;
        with_light += caption.find("at night") != std::string::npos;
    }
    EXPECT_NEAR(objects, 48, 25);
    EXPECT_NEAR(with_light, 340, 30);
}

TEST(PriorCaptions, PartsHaveWordsOfTheirOwn) {
    EXPECT_EQ(part_with_article("handle", "orange {o}"), "an orange handle");
    EXPECT_EQ(part_with_article("wheels", "black {o}"), "black wheels");
    EXPECT_EQ(part_with_article("icing", "pink {o}"), "pink icing");
    const ImageWords car{
        {"car"}, {"{o} made of wood", "wooden {o}"}, {""}, PartWords{"wheels", {"red {o}"}}};
    std::set<std::string> captions;
    for (std::uint64_t i = 0; i < 300; ++i) {
        Random random(6, i);
        captions.insert(make_caption(random, car));
    }
    EXPECT_TRUE(captions.count("a wooden car with red wheels"));
    EXPECT_TRUE(captions.count("a wooden car that has red wheels"));
    EXPECT_TRUE(captions.count("red wheels on a wooden car"));
    EXPECT_TRUE(captions.count("a photo of a wooden object with red wheels"));
}

TEST(PriorCaptions, NounsOfObjectsAreSingleWordsAndMeanOneThing) {
    std::set<std::string> nouns;
    for (const ShapeClass& shape : shape_classes())
        for (const std::string& noun : shape.nouns) {
            EXPECT_TRUE(nouns.insert(noun).second) << noun;
            EXPECT_EQ(noun.find(' '), std::string::npos) << noun;
        }
    // A material word that is also the name of an object would be ambiguous in a sentence.
    for (const MaterialWord& word : material_words())
        EXPECT_FALSE(nouns.count(word.word)) << word.word;
    for (const PlainColor& color : plain_colors())
        EXPECT_FALSE(nouns.count(color.name)) << color.name;
}

TEST(PriorCaptions, TheVocabularyIsWide) {
    int held_out = 0;
    for (const ShapeClass& shape : shape_classes())
        held_out += shape.held_out;
    EXPECT_GE(shape_classes().size(), 44u);
    EXPECT_GE(held_out, 3);
    EXPECT_GE(material_words().size(), 50u);
    EXPECT_EQ(plain_colors().size(), 24u);
    EXPECT_EQ(light_kinds().size(), 10u);
    for (const MaterialWord& word : material_words()) {
        Random random(2);
        EXPECT_EQ(make_material(random, word.wish).kind, word.wish.kind);
        EXPECT_NE(word.caption.find("{o}"), std::string::npos);
        EXPECT_FALSE(word.spellings.empty());
    }
}

TEST(PriorCaptions, WhatComesInAnyColorHasACaptionThatSaysWhich) {
    int with_colors = 0;
    for (const MaterialWord& word : material_words()) {
        if (word.colored_caption.empty()) continue;
        ++with_colors;
        EXPECT_NE(word.colored_caption.find("{c}"), std::string::npos) << word.word;
        EXPECT_NE(word.colored_caption.find("{o}"), std::string::npos) << word.word;
        Random random(3);
        EXPECT_EQ(make_material(random, {word.wish.kind, "red", "white"}).color, "red")
            << word.word;
    }
    EXPECT_GE(with_colors, 10);
    EXPECT_TRUE(colors_alike("navy", "black"));
    EXPECT_FALSE(colors_alike("navy", "white"));
}

TEST(PriorCaptions, PatternsComeAsOftenAsAsked) {
    std::set<std::string> patterns;
    for (const MaterialWord& word : material_words())
        if (word.group == "patterns") patterns.insert(word.wish.kind);
    for (const auto& [weight, share] : {std::pair{0.0f, 0.0}, {1.0f, .387}, {3.0f, .654}}) {
        MaterialWish wish;
        wish.pattern_weight = weight;
        int found = 0;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            Random random(6, i);
            found += static_cast<int>(patterns.count(make_material(random, wish).kind));
        }
        EXPECT_NEAR(found / 4000.0, share, .03) << weight;
    }
}

TEST(PriorCaptions, EveryMaterialSaysWhatItIs) {
    // Some phrases depend on the colours, so each kind is drawn several times.
    for (std::size_t i = 0; i < 6 * material_kinds().size(); ++i) {
        const std::string& kind = material_kinds()[i / 6];
        Random random(4, i);
        const ProceduralMaterial material = make_material(random, {kind, "", ""});
        EXPECT_EQ(material.kind, kind);
        ASSERT_FALSE(material.phrases.empty());
        EXPECT_TRUE(material.phrases[0].ends_with("{o}")) << kind;
        for (const std::string& phrase : material.phrases)
            EXPECT_NE(phrase.find("{o}"), std::string::npos) << phrase;
        for (int point = 0; point < 200; ++point) {
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
            EXPECT_LT(glm::length(value.slope), 6) << kind;
            EXPECT_NEAR(glm::length(bent_normal(n, value.slope)), 1, 1e-4) << kind;
        }
    }
}

TEST(PriorTokenizer, EveryWordIsOneTokenAndCaptionsFit) {
    const std::vector<WordCount> words = caption_vocabulary(2, 20000);
    EXPECT_GT(words.size(), 300u);
    const ClipTokenizer tokenizer = train_tokenizer(words, longest_caption + 2);
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
        ImageWords words_of_it{
            {"snowman"}, make_material(random).phrases, {" on an overcast day"}, {}};
        if (i % 2 == 0) words_of_it.part = PartWords{"hat", make_material(random).phrases};
        const std::string caption = make_caption(random, words_of_it);
        EXPECT_LE(tokenizer.encode(caption).size(), longest_caption + 2) << caption;
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

}  // namespace
}  // namespace item3d
