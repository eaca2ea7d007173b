#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/vision_language/blip.h"
#include "item3d/networks/vision_language/blip2.h"
#include "item3d/networks/vision_language/captioner.h"
#include "item3d/tensors/weights.h"
#include "item3d/text/bert_tokenizer.h"
#include "item3d/text/gpt2_tokenizer.h"
#include "tests/support/networks.h"

#include <sstream>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using testing::fixture;
using testing::Golden;
using testing::message_of;
using testing::TemporaryFolder;

void expect_tokens(const CaptionTokenizer& tokenizer, const fs::path& file) {
    for (const auto& row : nlohmann::json::parse(read_text(file))) {
        const auto text = row.at("text").get<std::string>();
        const auto ids = row.at("ids").get<std::vector<int>>();
        EXPECT_EQ(tokenizer.encode(text), ids) << text;
        EXPECT_EQ(tokenizer.decode(ids), row.at("decoded").get<std::string>()) << text;
    }
}

TEST(CaptionTokenizers, GiveTheReferencesIdsAndTexts) {
    expect_tokens(BertTokenizer::load(fixture("blip")), fixture("blip") / "tokens.json");
    expect_tokens(Gpt2Tokenizer::load(fixture("gpt2_tokenizer")),
                  fixture("gpt2_tokenizer") / "tokens.json");
}

TEST(CaptionTokenizers, BertReadsTokenizerJsonInPlaceOfItsVocabulary) {
    const TemporaryFolder folder;
    nlohmann::json vocabulary = nlohmann::json::object();
    std::istringstream lines(read_text(fixture("blip") / "vocab.txt"));
    for (std::string line; std::getline(lines, line);)
        vocabulary[line] = vocabulary.size();
    const auto write = [&] {
        const nlohmann::json model{{"type", "WordPiece"}, {"vocab", vocabulary}};
        testing::write_file(folder.path() / "tokenizer.json",
                            nlohmann::json{{"model", model}}.dump());
    };
    fs::copy_file(fixture("blip") / "tokenizer_config.json",
                  folder.path() / "tokenizer_config.json");
    write();
    expect_tokens(BertTokenizer::load(folder.path()), fixture("blip") / "tokens.json");
    vocabulary["far"] = 1 << 20;
    write();
    EXPECT_THROW(BertTokenizer::load(folder.path()), InputError);
}

TEST(CaptionTokenizers, TakeTextThatIsNotUtf8) {
    const auto bert = BertTokenizer::load(fixture("blip"));
    EXPECT_EQ(bert.encode("a \xff\xfe"), bert.encode("a"));  // U+FFFD is a control character
    const auto gpt2 = Gpt2Tokenizer::load(fixture("gpt2_tokenizer"));
    EXPECT_EQ(gpt2.decode(gpt2.encode("a\xff")), "a\xef\xbf\xbd");
    EXPECT_EQ(gpt2.decode({-1, 100000, 68}), "a");
    EXPECT_EQ(bert.decode({-1, 100000, 5}), "a");
}

TEST(Blip, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden("blip");
    BlipModel model = load_blip(fixture("blip"));
    const at::Tensor embeds = model->image_embeds(golden.in("pixel_values"));
    golden.expect("image_embeds", embeds);
    golden.expect("logits",
                  model->logits(model->decode(golden.in("input_ids"), golden.in("attention_mask"),
                                              model->read_image(embeds))));
}

TEST(Blip, WritesTheReferencesCaptions) {
    const Golden golden("blip");
    const BlipModel model = load_blip(fixture("blip"));
    const at::Tensor pixels = golden.in("pixel_values");
    const at::Tensor begin = at::full({1, 1}, model->config().bos_token_id, at::kLong);
    const at::Tensor prompt = at::cat({begin, golden.out("prompt_ids").slice(1, 1, -1)}, 1);
    DecodingOptions options;
    options.max_new_tokens = 12;
    EXPECT_TRUE(
        write_captions(model, pixels, begin, options).tokens.equal(golden.out("greedy_ids")));
    EXPECT_TRUE(write_captions(model, pixels, prompt, options)
                    .tokens.equal(golden.out("greedy_ids_prompt")));
    options.beams = 3;
    const Decoded beams = write_captions(model, pixels, begin, options);
    EXPECT_TRUE(beams.tokens.equal(golden.out("beam_ids")));
    golden.expect("beam_sequences_scores", beams.scores);
    EXPECT_TRUE(
        write_captions(model, pixels, prompt, options).tokens.equal(golden.out("beam_ids_prompt")));
    options.max_new_tokens = 1000;
    EXPECT_THROW(write_captions(model, pixels, begin, options), InputError);
}

TEST(Blip2, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden("blip2");
    Blip2Model model = load_blip2(fixture("blip2"));
    const at::Tensor image =
        model->project(model->query_image(model->image_embeds(golden.in("pixel_values"))));
    golden.expect("language_projection", image);
    OptModel language_model = model->language_model();
    golden.expect("logits",
                  language_model->logits(language_model->forward(
                      model->embed(golden.in("input_ids"), image), golden.in("attention_mask"))));
}

TEST(Blip2, WritesTheReferencesCaptions) {
    const Golden golden("blip2");
    const Blip2Model model = load_blip2(fixture("blip2"));
    const at::Tensor pixels = golden.in("pixel_values");
    const at::Tensor visible = golden.out("prompt_mask");
    DecodingOptions options;
    options.max_new_tokens = 12;
    options.end_token = model->config().text.eos_token_id;
    for (const auto& [beams, name] : {std::pair{1, "greedy_ids_prompt"}, {3, "beam_ids_prompt"}}) {
        options.beams = beams;
        EXPECT_TRUE(write_captions(model, pixels, golden.out("prompt_ids"), visible, options)
                        .tokens.equal(golden.out(name)))
            << name;
    }
}

/// Returns a BLIP-2 of random weights, for tests of properties that hold for any weights.
Blip2Model random_blip2() {
    const nlohmann::json layers = {{"hidden_size", 16},
                                   {"intermediate_size", 24},
                                   {"num_hidden_layers", 2},
                                   {"num_attention_heads", 2}};
    nlohmann::json vision = layers, qformer = layers, text = layers;
    vision.update({{"image_size", 8}, {"patch_size", 4}});
    qformer.update({{"encoder_hidden_size", 16}});
    text.update({{"model_type", "opt"}, {"vocab_size", 40}, {"max_position_embeddings", 24}});
    Blip2Model model(Blip2Config::from_config(Config({{"vision_config", vision},
                                                      {"qformer_config", qformer},
                                                      {"text_config", text},
                                                      {"num_query_tokens", 3},
                                                      {"image_token_index", 39}},
                                                     "config.json")));
    at::manual_seed(4);
    const at::NoGradGuard no_grad;
    for (auto& parameter : model->parameters())
        parameter.normal_(0, 0.3);
    return model;
}

TEST(Blip2, PaddingOnTheLeftChangesNothing) {
    const Blip2Model model = random_blip2();
    at::manual_seed(5);
    const at::Tensor pixels = at::randn({1, 3, 8, 8});
    const at::Tensor prompt = at::tensor({39, 39, 39, 2, 7, 11}, at::kLong).view({1, 6});
    const at::Tensor padded = at::constant_pad_nd(prompt, {4, 0}, 1);
    const at::Tensor visible = padded.ne(1).to(at::kLong);
    DecodingOptions options;
    options.max_new_tokens = 8;
    options.end_token = 2;
    for (const int beams : {1, 3}) {
        options.beams = beams;
        const at::Tensor plain = write_captions(model, pixels, prompt, {}, options).tokens;
        EXPECT_GT(plain.size(1), prompt.size(1) + 1);
        EXPECT_TRUE(write_captions(model, pixels, padded, visible, options)
                        .tokens.slice(1, 4)
                        .equal(plain));
    }
}

TEST(Blip2, TheCacheChangesNothing) {
    const at::NoGradGuard no_grad;
    const Blip2Model model = random_blip2();
    OptModel language_model = model->language_model();
    const at::Tensor ids = at::tensor({2, 5, 8, 13, 21, 2, 6, 7, 8, 9}, at::kLong).view({2, 5});
    const at::Tensor visible = at::ones_like(ids);
    const at::Tensor whole = language_model->forward(language_model->embed(ids), visible);
    KeyValueCache cache;
    std::vector<at::Tensor> pieces;
    for (const auto& [begin, stop] : {std::pair{0, 3}, {3, 4}, {4, 5}})
        pieces.push_back(language_model->forward(language_model->embed(ids.slice(1, begin, stop)),
                                                 visible.slice(1, 0, stop), &cache));
    EXPECT_LT(testing::largest_difference(at::cat(pieces, 1), whole), 1e-5);
    cache.select(at::tensor({1, 1}, at::kLong));
    EXPECT_TRUE(cache.layers[0].keys[0].equal(cache.layers[0].keys[1]));
}

class CaptionerFolder : public ::testing::Test {
  protected:
    CaptionerFolder() {
        for (const auto& entry : fs::directory_iterator(fixture("blip")))
            fs::copy_file(entry.path(), folder_.path() / entry.path().filename());
        fs::permissions(folder_.path() / "model.safetensors", fs::perms::owner_all);
    }
    std::string failure() const {
        return message_of<InputError>([&] { load_captioner(folder_.path()); });
    }
    TemporaryFolder folder_;
};

TEST_F(CaptionerFolder, GivesSentences) {
    const auto captioner = load_captioner(folder_.path());
    at::manual_seed(2);
    const at::Tensor bytes = at::randint(256, {50, 70, 4}, at::kByte);
    CaptionOptions options;
    options.max_new_tokens = 6;
    options.beams = 2;
    const std::string plain = captioner->caption(bytes, options);
    EXPECT_EQ(captioner->caption(bytes, options), plain);
    // Images in a batch get the same captions as single images.
    const at::Tensor other = at::randint(256, {32, 32, 3}, at::kByte);
    const auto both = captioner->captions({bytes, other}, options);
    ASSERT_EQ(both.size(), 2u);
    EXPECT_EQ(both[0].text, plain);
    EXPECT_EQ(both[1].text, captioner->caption(other, options));
    options.prefix = "A picture of";
    EXPECT_TRUE(captioner->caption(bytes, options).starts_with("a picture of"));
    options.prefix = std::string(200, 'x') + " " + std::string(200, '!');
    EXPECT_THROW(captioner->caption(bytes, options), InputError);
}

TEST_F(CaptionerFolder, TellsWhichCaptionsCameToAnEnd) {
    const auto captioner = load_captioner(folder_.path());
    at::manual_seed(2);
    std::vector<at::Tensor> images;
    for (int i = 0; i < 8; ++i)
        images.push_back(at::randint(256, {32, 32, 3}, at::kByte));
    CaptionOptions options;
    const auto captions = captioner->captions(images, options);
    options.max_new_tokens = 40;
    const auto longer = captioner->captions(images, options);
    int ended = 0;
    for (std::size_t i = 0; i < captions.size(); ++i) {
        ended += captions[i].ended ? 1 : 0;
        EXPECT_EQ(captions[i].text == longer[i].text, captions[i].ended) << i;
    }
    EXPECT_GT(ended, 0);
    EXPECT_LT(ended, 8);
}

TEST_F(CaptionerFolder, NamesWhatIsMissingOrWrong) {
    fs::resize_file(folder_.path() / "model.safetensors", 200000);
    EXPECT_NE(failure().find("model.safetensors"), std::string::npos);
    testing::write_file(folder_.path() / "preprocessor_config.json", R"({"size": 32})");
    EXPECT_NE(failure().find("does not scale"), std::string::npos);
    fs::remove(folder_.path() / "vocab.txt");
    EXPECT_NE(failure().find("vocab.txt"), std::string::npos);
    testing::write_file(folder_.path() / "vocab.txt", "[PAD]\n[UNK]\n[CLS]\n[SEP]\n");
    EXPECT_NE(failure().find("[MASK]"), std::string::npos);
    testing::write_file(folder_.path() / "config.json",
                        R"({"architectures": ["BlipForQuestionAnswering"]})");
    EXPECT_NE(failure().find("BlipForConditionalGeneration"), std::string::npos);
    EXPECT_EQ(failure().find('\n'), std::string::npos);
}

TEST(Captioners, RejectOtherLanguageModels) {
    EXPECT_THROW(OptConfig::from_config(Config({{"model_type", "t5"}}, "config.json")), InputError);
    EXPECT_THROW(OptConfig::from_config(Config(
                     {{"model_type", "opt"}, {"do_layer_norm_before", false}}, "config.json")),
                 InputError);
    EXPECT_THROW(Blip2Config::from_config(Config(nlohmann::json::object(), "config.json")),
                 InputError);
}

}  // namespace
}  // namespace item3d
