#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/generate.h"
#include "item3d/networks/diffusion/pipeline.h"

namespace item3d::parity {

void check_pipeline(Case& golden) {
    set_verbosity(Verbosity::quiet);
    const Config meta = golden.meta();
    const Pipeline pipeline = Pipeline::load(golden.folder());
    if (!meta.has("prompts") || !meta.json()["prompts"].is_array())
        meta.fail("prompts", "a list of [prompt, negative prompt]");

    for (std::size_t i = 0; i < meta.json()["prompts"].size(); ++i) {
        const auto& pair = meta.json()["prompts"][i];
        if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string())
            meta.fail("prompts", "a list of [prompt, negative prompt]");
        GenerateOptions options;
        options.prompt = pair[0].get<std::string>();
        if (pair[1].is_string()) options.negative_prompt = pair[1].get<std::string>();
        options.steps = meta.size("steps", 5);
        options.guidance_scale = static_cast<float>(meta.number("guidance", 7.5));
        const std::string number = "_" + std::to_string(i);
        options.latents = golden.input("latents" + number);

        const auto compare_text = [&](const std::string& prefix, const std::string& pooled,
                                      const std::string& prompt, const TextEmbedding& text) {
            golden.compare(prefix + "prompt_ids" + number,
                           pipeline.tokenizer().encode_batch({prompt}), within::exact);
            golden.compare(prefix + "prompt_embeds" + number, text.states, within::one_pass);
            if (pipeline.is_sdxl()) golden.compare(pooled + number, text.pooled, within::one_pass);
        };
        compare_text("", "pooled", options.prompt, pipeline.encode_text({options.prompt}));
        const std::string negative = options.negative_prompt.value_or("");
        compare_text(
            "negative_", "negative_pooled", negative,
            options.negative_prompt ? pipeline.encode_text({negative}) : pipeline.encode_no_text());
        const at::Tensor latents = generate_latents(pipeline, options);
        golden.compare("latents" + number, latents, within::several_steps);
        const at::Tensor decoded = pipeline.decode_image(latents);
        golden.compare("decoded" + number, decoded, within::several_steps);
        golden.compare("image" + number, (decoded / 2 + 0.5).clamp(0, 1).permute({0, 2, 3, 1}),
                       within::image);
    }
}

}  // namespace item3d::parity
