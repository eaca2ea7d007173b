#include "item3d/networks/diffusion/textual_inversion.h"

#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed,
                                                item3d::fuzz::split_safetensors,
                                                item3d::fuzz::join_safetensors))

ITEM3D_FUZZ_TARGET(textual_inversion, data, size) {
    using namespace item3d;
    static const auto model = std::filesystem::path(ITEM3D_TEST_DATA) / "models/pipeline_sd";
    static const ClipTokenizer tokenizer = ClipTokenizer::load(model / "tokenizer");
    static TextEncoderPair encoder;  // loaded again after an embedding was added to it
    return fuzz::read_or_refuse([&] {
        const auto file = fuzz::as_file("embedding.safetensors", fuzz::as_text(data, size));
        if (!encoder.tokenizer)
            encoder = {std::make_shared<ClipTokenizer>(tokenizer),
                       load_clip_text(model / "text_encoder")};
        const std::string token = add_embedding(file, "", {encoder});
        const std::shared_ptr<ClipTokenizer> changed = std::move(encoder.tokenizer);
        changed->encode_padded("a " + token + " mug");
    });
}
