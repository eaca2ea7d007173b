#include "item3d/text/clip_tokenizer.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/text/normalization.h"
#include "tests/support/networks.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <sstream>

namespace item3d {
namespace {

using testing::message_of;
using testing::TemporaryFolder;
using Words = std::vector<std::string>;

/// Returns a tokenizer that has all bytes and the merges of a few words.
ClipTokenizer small_tokenizer(const ClipTokenizer::Options& options = {}) {
    ClipTokenizer::Vocabulary vocabulary;
    const auto add = [&](const std::string& token) {
        vocabulary.emplace(token, static_cast<int>(vocabulary.size()));
    };
    for (const char* ending : {"", "</w>"})
        for (const std::string& symbol : byte_symbols())
            add(symbol + ending);
    const ClipTokenizer::Merges merges = {{"r", "e"},      {"re", "d</w>"}, {"m", "u"},
                                          {"mu", "g</w>"}, {"e", "d</w>"},  {"a", "a"}};
    for (const auto& [left, right] : merges)
        add(left + right);
    add("<|startoftext|>");
    add("<|endoftext|>");
    return ClipTokenizer(vocabulary, merges, options);
}

TEST(ClipTokenizer, SplitsWordsAsTheReferenceDoes) {
    EXPECT_EQ(ClipTokenizer::split_words("A  RED\tmug"), (Words{"a", "red", "mug"}));
    EXPECT_EQ(ClipTokenizer::split_words("it's they'd 4k, 12!?"),
              (Words{"it", "'s", "they", "'d", "4", "k", ",", "1", "2", "!?"}));
    EXPECT_EQ(ClipTokenizer::split_words("rock'n'roll"), (Words{"rock", "'", "n", "'", "roll"}));
    // Words are in NFC. Lower case is letter by letter, so there is no final sigma, and U+0130
    // becomes two code points.
    EXPECT_EQ(ClipTokenizer::split_words("Cafe\u0301 ΣΑΣ \u0130"),
              (Words{"caf\u00e9", "σασ", "i", "\u0307"}));
    EXPECT_EQ(ClipTokenizer::split_words("a\u00a0b\u3000c"), (Words{"a", "b", "c"}));
    EXPECT_EQ(ClipTokenizer::split_words("\xff\xfe"), (Words{"\ufffd\ufffd"}));
}

TEST(ClipTokenizer, NamesTheWordsThatAreLost) {
    const ClipTokenizer tokenizer = small_tokenizer();
    EXPECT_EQ(tokenizer.lost_words("red mug red"), "");
    EXPECT_EQ(tokenizer.lost_words("red mug red", 5), "");
    EXPECT_EQ(tokenizer.lost_words("red mug red", 4), "red");
    EXPECT_EQ(tokenizer.lost_words("red mug Red", 3), "mug red");

    ::testing::internal::CaptureStderr();
    warn_of_lost_words(tokenizer, "--to", "red mug", 4);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    ::testing::internal::CaptureStderr();
    warn_of_lost_words(tokenizer, "--to", "red mug red", 4);
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("--to: the text is longer than the limit of 4 tokens"), std::string::npos)
        << said;
    EXPECT_NE(said.find("ignored: \"red\""), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
}

TEST(ClipTokenizer, MergesByRank) {
    const ClipTokenizer tokenizer = small_tokenizer();
    const auto ids = [&](const Words& tokens) {
        std::vector<int> result{tokenizer.bos_id()};
        for (const auto& token : tokens)
            result.push_back(tokenizer.id_of(token));
        result.push_back(tokenizer.eos_id());
        return result;
    };
    EXPECT_EQ(tokenizer.encode("Red mug"), ids({"red</w>", "mug</w>"}));
    EXPECT_EQ(tokenizer.encode("bed"), ids({"b", "ed</w>"}));
    EXPECT_EQ(tokenizer.encode("aaaa"), ids({"aa", "a", "a</w>"}));
    EXPECT_EQ(tokenizer.encode(""), ids({}));
    EXPECT_EQ(tokenizer.decode(tokenizer.encode("Red  mug, \u00e9!")), "red mug , \u00e9 !");
}

TEST(ClipTokenizer, PadsAndTruncatesKeepingTheEndToken) {
    ClipTokenizer::Options options;
    options.model_max_length = 5;
    const ClipTokenizer tokenizer = small_tokenizer(options);
    const int end = tokenizer.eos_id(), red = tokenizer.id_of("red</w>");
    EXPECT_EQ(tokenizer.encode_padded("red"),
              (std::vector<int>{tokenizer.bos_id(), red, end, end, end}));
    EXPECT_EQ(tokenizer.encode_padded("red red red red red"),
              (std::vector<int>{tokenizer.bos_id(), red, red, red, end}));
    const at::Tensor batch = tokenizer.encode_batch({"red", ""}, 7);
    EXPECT_EQ(batch.sizes(), (std::vector<std::int64_t>{2, 7}));
    EXPECT_EQ(batch[1][1].item<int>(), end);
}

TEST(ClipTokenizer, FindsSpecialTokensRawOrNormalised) {
    ClipTokenizer::Options options;
    options.bos.normalized = true;
    options.pad.content = "!";
    const ClipTokenizer tokenizer = small_tokenizer(options);
    const int start = tokenizer.bos_id(), end = tokenizer.eos_id(),
              red = tokenizer.id_of("red</w>");
    EXPECT_EQ(tokenizer.encode("red<|endoftext|>red"),
              (std::vector<int>{start, red, end, red, end}));
    EXPECT_EQ(tokenizer.encode("red<|STARTOFTEXT|>red"),
              (std::vector<int>{start, red, start, red, end}));
    EXPECT_GT(tokenizer.encode("red<|ENDOFTEXT|>red").size(), 5u);
    EXPECT_EQ(tokenizer.encode("red!"), (std::vector<int>{start, red, tokenizer.pad_id(), end}));
    EXPECT_EQ(tokenizer.decode({start, red, end}, false), "<|startoftext|>red <|endoftext|>");
}

TEST(ClipTokenizer, SurvivesSavingAndLoading) {
    ClipTokenizer::Options options;
    options.bos.normalized = true;
    options.model_max_length = 20;
    const ClipTokenizer tokenizer = small_tokenizer(options);
    const TemporaryFolder folder;
    tokenizer.save(folder.path());
    const ClipTokenizer again = ClipTokenizer::load(folder.path());
    EXPECT_EQ(again.model_max_length(), 20);
    EXPECT_EQ(again.size(), tokenizer.size());
    for (const char* text : {"a red mug", "red<|STARTOFTEXT|>red", "\u00e9\u4e2d'll 12"})
        EXPECT_EQ(again.encode(text), tokenizer.encode(text)) << text;
}

/// Replaces vocab.json and merges.txt by a tokenizer.json.
void join_files(const std::filesystem::path& folder, bool merges_are_pairs) {
    nlohmann::json merges = nlohmann::json::array();
    std::istringstream lines(read_text(folder / "merges.txt"));
    std::string left, right;
    std::getline(lines, left);  // skips the version
    while (lines >> left >> right) {
        if (merges_are_pairs)
            merges.push_back({left, right});
        else
            merges.push_back(left + " " + right);
    }
    nlohmann::json vocabulary = nlohmann::json::parse(read_text(folder / "vocab.json"));
    nlohmann::json added = nlohmann::json::array();
    for (const char* token : {"<|startoftext|>", "<|endoftext|>"}) {
        const bool begins = std::string(token) == "<|startoftext|>";
        added.push_back({{"id", vocabulary.at(token)}, {"content", token}, {"normalized", begins}});
        vocabulary.erase(token);
    }
    const nlohmann::json model{{"type", "BPE"}, {"vocab", vocabulary}, {"merges", merges}};
    testing::write_file(folder / "tokenizer.json",
                        nlohmann::json{{"added_tokens", added}, {"model", model}}.dump());
    std::filesystem::remove(folder / "vocab.json");
    std::filesystem::remove(folder / "merges.txt");
}

TEST(ClipTokenizer, ReadsTheOneFileOfNewerPrograms) {
    ClipTokenizer::Options options;
    options.bos.normalized = true;
    const ClipTokenizer tokenizer = small_tokenizer(options);
    for (const bool merges_are_pairs : {false, true}) {
        const TemporaryFolder folder;
        tokenizer.save(folder.path());
        std::filesystem::remove(folder.path() / "special_tokens_map.json");
        join_files(folder.path(), merges_are_pairs);
        const ClipTokenizer again = ClipTokenizer::load(folder.path());
        EXPECT_EQ(again.size(), tokenizer.size());
        for (const char* text : {"a red mug", "red<|STARTOFTEXT|>red<|endoftext|>", "\u00e9'll 12"})
            EXPECT_EQ(again.encode(text), tokenizer.encode(text)) << text;
        const auto damaged = [&](const std::string& text, const char* wanted) {
            testing::write_file(folder.path() / "tokenizer.json", text);
            const std::string message =
                message_of<InputError>([&] { ClipTokenizer::load(folder.path()); });
            EXPECT_NE(message.find("tokenizer.json"), std::string::npos) << message;
            EXPECT_NE(message.find(wanted), std::string::npos) << message;
        };
        damaged("{}", "model");
        damaged(R"({"model": {"type": "Unigram", "vocab": {}}})", "type");
        damaged(R"({"model": {"type": "BPE", "vocab": {"a": -1}, "merges": []}})", "an id");
        damaged(R"({"model": {"type": "BPE", "vocab": {"a": 0}}})", "merges");
        damaged(R"({"model": {"type": "BPE", "vocab": {"a": 0}, "merges": [3]}})", "merges");
    }
}

TEST(ClipTokenizer, RejectsVocabulariesThatDoNotFit) {
    const TemporaryFolder folder;
    small_tokenizer().save(folder.path());
    const auto load = [&] { ClipTokenizer::load(folder.path()); };
    testing::write_file(folder.path() / "merges.txt", "#version: 0.2\nr e\nq x\n");
    EXPECT_NE(message_of<InputError>(load).find("'qx'"), std::string::npos);
    testing::write_file(folder.path() / "merges.txt", "#version: 0.2\nre\n");
    EXPECT_NE(message_of<InputError>(load).find("line 2"), std::string::npos);
    testing::write_file(folder.path() / "merges.txt", "");
    testing::write_file(folder.path() / "vocab.json", R"({"a": 0})");
    EXPECT_NE(message_of<InputError>(load).find("vocab.json"), std::string::npos);
    testing::write_file(folder.path() / "vocab.json", R"({"a": -3})");
    EXPECT_THROW(load(), InputError);
    testing::write_file(folder.path() / "vocab.json", "{");
    EXPECT_THROW(load(), InputError);
}

TEST(ClipTokenizer, LongWordsTakeLinearTime) {
    const ClipTokenizer tokenizer = small_tokenizer();
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(tokenizer.encode(std::string(200'000, 'a')).size(), 100'003u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(ClipTokenizer, ReproducesTheReferenceOnTheFullVocabulary) {
    const std::filesystem::path folder =
        std::filesystem::path(ITEM3D_SHARED_DATA) / "goldens" / "tokenizer_clip";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the vocabulary is not ours to ship";
    const auto rows = nlohmann::json::parse(read_text(folder / "tokens.json"));
    for (const char* variant : {"sd15", "sd21"}) {
        const ClipTokenizer tokenizer = ClipTokenizer::load(folder / variant, folder / "sd15");
        for (const auto& row : rows) {
            const auto text = row["text"].get<std::string>();
            const auto ids = row[variant].get<std::vector<int>>();
            EXPECT_EQ(tokenizer.encode(text), ids) << text;
            if (variant == std::string("sd15")) {
                EXPECT_EQ(tokenizer.decode(ids), row["decoded"].get<std::string>());
            }
        }
    }
}

}  // namespace
}  // namespace item3d
