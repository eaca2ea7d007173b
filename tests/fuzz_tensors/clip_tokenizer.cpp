#include "item3d/text/clip_tokenizer.h"

#include "tests/fuzz/mutate.h"

/// Loads a tokenizer from vocab.json, merges.txt, tokenizer_config.json and
/// special_tokens_map.json, and encodes a sentence, which is the input's last part.
ITEM3D_FUZZ_TARGET(clip_tokenizer, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto folder = fuzz::as_files("clip_tokenizer",
                                           {"vocab.json", "merges.txt", "tokenizer_config.json",
                                            "special_tokens_map.json", "sentence.txt"},
                                           fuzz::as_text(data, size));
        ClipTokenizer tokenizer = ClipTokenizer::load(folder);
        const auto sentence = folder / "sentence.txt";
        const std::string text =
            std::filesystem::exists(sentence) ? read_text(sentence) : "a red mug";
        tokenizer.decode(tokenizer.encode(text));
        tokenizer.lost_words(text, 8);
        tokenizer.encode_batch({text, "a golden mug"}, 8);
        tokenizer.add_placeholder("<new>", 2, "embedding");
    });
}
