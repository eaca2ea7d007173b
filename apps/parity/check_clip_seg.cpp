#include "apps/parity/parity.h"
#include "item3d/io/load.h"
#include "item3d/networks/vision_language/clip_seg.h"
#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/render/image_tensor.h"
#include "item3d/text/clip_tokenizer.h"

namespace item3d::parity {

void check_clip_seg(Case& golden) {
    const Config meta = golden.meta();
    const auto prompts = meta.texts("prompts", {}), names = meta.texts("images", {});
    const ClipTokenizer tokenizer = ClipTokenizer::load(golden.folder() / "tokenizer");
    const at::Tensor ids = tokenizer.encode_batch(prompts);
    golden.compare("input_ids", ids, within::exact);
    for (const std::string kind : {"plain", "refined"}) {
        ClipSegModel model = load_clip_seg(golden.folder() / kind);
        const ImageProcessor processor = ImageProcessor::load(golden.folder() / kind);
        const at::Tensor asked = model->conditional_embeddings(ids);
        golden.compare(kind + ".conditional_embeddings", asked, within::one_pass);
        const at::Tensor pixels = golden.input("pixel_values");
        const auto activations = model->activations(pixels);
        for (std::size_t i = 0; i < activations.size(); ++i)
            golden.compare(kind + ".activation_" + std::to_string(i), activations[i],
                           within::one_pass);
        // Each image of these inputs has one prompt. Each image from a file has all prompts.
        for (const auto& [input, output] : {std::pair("pixel_values", ".logits_random"),
                                            std::pair("pixel_values_big", ".logits_big")})
            golden.compare(kind + output,
                           model->forward(golden.input(input), asked.unsqueeze(1)).squeeze(1),
                           within::one_pass);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Image image = load_image(golden.folder() / "images" / names[i]);
            const at::Tensor values =
                processor.process((to_tensor(image) * 255).round().to(at::kByte));
            const std::string number = std::to_string(i);
            if (kind == "plain")
                golden.compare("pixel_values." + number, values, within::scheduler_step);
            const at::Tensor logits = model->forward(values, asked)[0];
            golden.compare(kind + ".logits_" + number, logits, within::one_pass);
            golden.compare(kind + ".mask_" + number, at::sigmoid(logits), within::one_pass);
        }
        golden.skip(kind + ".decoder_", "states within the decoder");
    }
    golden.skip("attention_mask", "all tokens are read up to the end of the text anyway");
}

}  // namespace item3d::parity
