#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/models/pipeline.h"
#include "parity.h"

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
        options.negative_prompt = pair[1].is_string() ? pair[1].get<std::string>() : "";
        options.steps = meta.size("steps", 5);
        options.guidance_scale = static_cast<float>(meta.number("guidance", 7.5));
        const std::string number = "_" + std::to_string(i);
        options.latents = golden.input("latents" + number);

        golden.compare("prompt_ids" + number, pipeline.tokenizer->encode_batch({options.prompt}),
                       within::exact);
        golden.compare("negative_prompt_ids" + number,
                       pipeline.tokenizer->encode_batch({options.negative_prompt}), within::exact);
        golden.compare("prompt_embeds" + number, pipeline.encode_text({options.prompt}),
                       within::one_pass);
        golden.compare("negative_prompt_embeds" + number,
                       pipeline.encode_text({options.negative_prompt}), within::one_pass);
        const torch::Tensor latents = generate_latents(pipeline, options);
        golden.compare("latents" + number, latents, within::several_steps);
        const torch::Tensor decoded = pipeline.decode_image(latents);
        golden.compare("decoded" + number, decoded, within::several_steps);
        golden.compare("image" + number, (decoded / 2 + 0.5).clamp(0, 1).permute({0, 2, 3, 1}),
                       within::image);
    }
}

}  // namespace item3d::parity
