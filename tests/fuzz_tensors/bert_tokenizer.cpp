#include "item3d/text/bert_tokenizer.h"

#include "tests/fuzz/fuzz.h"

ITEM3D_FUZZ_TARGET(bert_tokenizer, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const auto folder = fuzz::as_files("bert_tokenizer", {"vocab.txt", "tokenizer_config.json"},
                                           fuzz::as_text(data, size));
        const BertTokenizer tokenizer = BertTokenizer::load(folder);
        tokenizer.decode(tokenizer.encode("a photo of 3 mugs, isn't it?"));
        tokenizer.decode({0, tokenizer.largest_id(), tokenizer.largest_id() + 1, -1});
    });
}
