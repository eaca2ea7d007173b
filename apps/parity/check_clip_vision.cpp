#include "apps/parity/parity.h"
#include "item3d/networks/vision_language/clip_model.h"
#include "item3d/networks/vision_language/clip_vision.h"

namespace item3d::parity {

void check_clip_vision(Case& golden) {
    ClipVisionWithProjection model = load_clip_vision(golden.folder());
    const ClipVisionOutput output = model(golden.input("pixel_values"));
    golden.compare("image_embeds", model->project(output), within::one_pass);
    golden.compare("last_hidden_state", output.last_hidden_state, within::one_pass);
    golden.compare("hidden_states_0", output.hidden_states.front(), within::one_pass);
    golden.compare("hidden_states_penultimate",
                   output.hidden_states[output.hidden_states.size() - 2], within::one_pass);
}

void check_clip_model(Case& golden) {
    ClipModel model = load_clip_model(golden.folder());
    const auto unit = [](const at::Tensor& x) { return x / x.norm(2, {-1}, true); };
    const at::Tensor ids = golden.input("input_ids");
    const at::Tensor text = model->text_features(ids);
    golden.compare("text_features", text, within::one_pass);
    golden.compare("text_features_masked",
                   model->text_features(ids, golden.input("attention_mask")), within::one_pass);
    golden.compare("text_embeds", unit(text), within::one_pass);

    at::Tensor pixels = golden.input("pixel_values").clone();
    {
        const at::AutoGradMode gradients(true);
        pixels.requires_grad_();
        const at::Tensor embeds = unit(model->image_features(pixels));
        (embeds * golden.input("cotangent")).sum().backward();
    }
    golden.compare("grad_pixel_values", pixels.grad(), within::one_pass);
    const at::Tensor image = model->image_features(pixels);
    golden.compare("image_features", image, within::one_pass);
    golden.compare("image_embeds", unit(image), within::one_pass);
    const at::Tensor logits = model->logit_scale() * unit(image).matmul(unit(text).t());
    golden.compare("logits_per_image", logits, within::one_pass);
    golden.compare("logits_per_text", logits.t(), within::one_pass);
    golden.compare("logit_scale_exp", model->logit_scale().reshape({1}), within::one_pass);

    const ClipVisionOutput vision = model->vision()(pixels);
    golden.compare("vision_last_hidden_state", vision.last_hidden_state, within::one_pass);
    golden.compare("vision_pooler_output", vision.pooled, within::one_pass);

    const auto images = compare_image_processors(golden);
    if (golden.has("out.png_image_features")) {
        const auto count = golden.expected("png_image_features").size(0);
        golden.compare("png_image_features",
                       model->image_features(at::cat(images).narrow(0, 0, count)),
                       within::one_pass);
    }
}

}  // namespace item3d::parity
