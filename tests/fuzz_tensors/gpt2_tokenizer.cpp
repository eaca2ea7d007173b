#include "item3d/text/gpt2_tokenizer.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(gpt2_tokenizer, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto folder = fuzz::as_files(
            "gpt2_tokenizer",
            {"vocab.json", "merges.txt", "tokenizer_config.json", "added_tokens.json"},
            fuzz::as_text(data, size));
        const Gpt2Tokenizer tokenizer = Gpt2Tokenizer::load(folder);
        tokenizer.decode(tokenizer.encode("a photo of 3 mugs, isn't it?"));
        tokenizer.decode({0, tokenizer.largest_id(), tokenizer.largest_id() + 1, -1});
    });
}
