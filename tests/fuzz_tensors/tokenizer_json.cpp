#include "item3d/text/bert_tokenizer.h"
#include "item3d/text/clip_tokenizer.h"
#include "item3d/text/gpt2_tokenizer.h"
#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Loads each of the three tokenizers from tokenizer.json alone.
ITEM3D_FUZZ_TARGET(tokenizer_json, data, size) {
    using namespace item3d;
    const auto folder =
        fuzz::as_files("tokenizer_json", {"tokenizer.json"}, fuzz::as_text(data, size));
    fuzz::read_or_refuse([&] { ClipTokenizer::load(folder).encode_padded("a red mug"); });
    fuzz::read_or_refuse([&] { Gpt2Tokenizer::load(folder).encode("a red mug"); });
    return fuzz::read_or_refuse([&] { BertTokenizer::load(folder).encode("a red mug"); });
}
