#include "item3d/networks/diffusion/textual_inversion.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/text_encoders.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::message_of;
using testing::TemporaryFolder;

TEST(TextualInversion, ReproducesTheReference) {
    const Golden golden("textual_inversion");
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const TextEncoderPair encoder{pipeline.text().tokenizer, pipeline.text().model};
    const auto folder = fixture("textual_inversion");
    EXPECT_EQ(add_embedding(folder / "learned_embeds.safetensors", "", {encoder}), "<cat-toy>");
    EXPECT_EQ(add_embedding(folder / "a1111_embeds.safetensors", "<style-x>", {encoder}),
              "<style-x>");
    const std::vector<std::string> prompts = {
        "a photo of <cat-toy>", "<cat-toy> in the style of <style-x>, highly detailed",
        "A<cat-toy>b <style-x><style-x>", "nothing special"};
    golden.expect("input_ids", pipeline.tokenizer().encode_batch(prompts), 0);
    golden.expect("last_hidden_state", pipeline.encode_text(prompts).states);
}

TEST(TextualInversion, IsCalledAfterTheFileAndItsVectorsAlone) {
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const ClipTokenizer& tokenizer = pipeline.tokenizer();
    const int before = tokenizer.largest_id();
    EXPECT_EQ(add_embedding(fixture("textual_inversion") / "a1111_embeds.safetensors", "",
                            {{pipeline.text().tokenizer, pipeline.text().model}}),
              "a1111_embeds");
    const std::vector<int> whole = tokenizer.encode("A1111_Embeds"),
                           one = tokenizer.encode("a1111_embeds_2");
    EXPECT_EQ(whole, (std::vector<int>{tokenizer.bos_id(), before + 1, before + 2, before + 3,
                                       tokenizer.eos_id()}));
    EXPECT_EQ(one, (std::vector<int>{tokenizer.bos_id(), before + 3, tokenizer.eos_id()}));
    // Prompts without the new word are unchanged.
    const Pipeline plain = Pipeline::load(fixture("pipeline_sd"));
    EXPECT_TRUE(
        plain.encode_text({"a duck"}).states.equal(pipeline.encode_text({"a duck"}).states));
}

TEST(TextualInversion, TeachesBothEncodersOfAPair) {
    const Pipeline first = Pipeline::load(fixture("pipeline_sd"));
    const Pipeline second = Pipeline::load(fixture("pipeline_sd"));
    const std::vector<TextEncoderPair> pair = {{first.text().tokenizer, first.text().model},
                                               {second.text().tokenizer, second.text().model}};
    const TemporaryFolder folder;
    const auto path = folder.path() / "style.safetensors";
    save_safetensors(path,
                     {{"clip_l", at::full({2, 32}, 0.5f)}, {"clip_g", at::full({2, 32}, -0.5f)}});
    EXPECT_EQ(add_embedding(path, "", pair), "style");
    for (const Pipeline* pipeline : {&first, &second}) {
        const auto parameters = pipeline->text().model->named_parameters();
        const at::Tensor table = parameters["embeddings.token_embedding.weight"];
        const int id = pipeline->tokenizer().encode("style")[1];
        EXPECT_TRUE(table[id].eq(pipeline == &first ? 0.5 : -0.5).all().item<bool>());
        EXPECT_EQ(pipeline->tokenizer().encode("a style").size(), 5u);
    }
    save_safetensors(path, {{"clip_l", at::ones({2, 32})}, {"clip_g", at::ones({1, 32})}});
    EXPECT_THROW(add_embedding(path, "other", pair), InputError);
}

TEST(TextualInversion, SaysWhatItCannotUse) {
    const Pipeline pipeline = Pipeline::load(fixture("pipeline_sd"));
    const TextEncoderPair encoder{pipeline.text().tokenizer, pipeline.text().model};
    const TemporaryFolder folder;
    const auto path = folder.path() / "word.safetensors";
    const auto complaint = [&](const NamedTensors& tensors, const std::string& token = "") {
        save_safetensors(path, tensors);
        return message_of<InputError>([&] { add_embedding(path, token, {encoder}); });
    };
    const auto has = [&](const std::string& message, const std::string& part) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
    };
    has(complaint({{"<a>", at::ones({31})}}), "31");
    has(complaint({{"<a>", at::ones({2, 2, 32})}}), "[2, 2, 32]");
    has(complaint({{"<a>", at::ones({76, 32})}}), "76 vectors");
    has(complaint({{"<a>", at::ones({32}, at::kLong)}}), "floating");
    has(complaint({{"<a>", at::ones({32})}, {"<b>", at::ones({32})}}), "2 tensors");
    has(complaint({{"clip_l", at::ones({1, 32})}, {"clip_g", at::ones({1, 32})}}), "SDXL");
    has(complaint({{"<a>", at::ones({32})}}, " "), "blank");
    has(complaint({{"<|endoftext|>", at::ones({32})}}), "already");
    save_safetensors(path, {{"<a>", at::ones({32})}});
    add_embedding(path, "", {encoder});
    has(message_of<InputError>([&] { add_embedding(path, "", {encoder}); }), "already");
    has(message_of<InputError>([&] { add_embedding(path, "<a>", {encoder, encoder}); }), "clip_l");
    for (const char* name : {"word.pt", "archive"}) {  // recognised by name or by its first bytes
        testing::write_file(folder.path() / name, "PK\x03\x04 and so on");
        has(message_of<InputError>([&] { add_embedding(folder.path() / name, "", {encoder}); }),
            "pickle");
    }
}

}  // namespace
}  // namespace item3d
