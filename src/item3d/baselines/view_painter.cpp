#include "item3d/baselines/view_painter.h"

namespace item3d {
namespace {

constexpr float unpainted = 0.5f;  ///< sRGB grey of unpainted texels

std::string with_side(const std::string& prompt, const std::string& side) {
    return prompt + ", " + side + " view";
}

}  // namespace

std::string prompt_of_side(const PaintingScene& scene, const std::string& side) {
    return scene.says_sides ? with_side(scene.prompt, side) : scene.prompt;
}

std::vector<std::string> painting_prompts(const std::string& prompt,
                                          const std::string& negative_prompt) {
    std::vector<std::string> prompts{prompt, negative_prompt, ""};
    for (const char* side : {"front", "left", "right", "back", "overhead", "bottom"})
        prompts.push_back(with_side(prompt, side));
    return prompts;
}

ViewPainter::ViewPainter(const PaintingScene& scene, const PainterOptions& options)
    : scene_(scene), options_(options) {
    colors_ = at::where(scene.weight > 0, unpainted, scene.source);
    painted_ = at::zeros({scene.texels->count()}, scene.source.options());
}

at::Tensor ViewPainter::colors() const {
    return colors_;
}

NamedTensors ViewPainter::state() const {
    NamedTensors tensors{{"colors", colors_}, {"painted", painted_}};
    if (!images_.empty()) tensors.emplace_back("pictures", at::cat(images_));
    return tensors;
}

void ViewPainter::load_state(const CheckpointReader& reader) {
    reader.copy("colors", colors_);
    reader.copy("painted", painted_);
    images_.clear();
    if (reader.has("pictures"))
        for (const at::Tensor& image : reader.get("pictures").split(1))
            images_.push_back(image.to(colors_.device()));
}

GuidedModel ViewPainter::guided(const ViewRender& render, const at::Tensor& latents) const {
    GuidedModel model(*scene_.prior, prompt_of_side(scene_, render.view().side),
                      scene_.negative_prompt, options_.cfg);
    model.condition = render.condition(*scene_.prior, latents);
    return model;
}

at::Tensor ViewPainter::encode(const at::Tensor& image) const {
    const at::NoGradGuard no_grad;
    return scene_.prior->encode_image(image * 2 - 1);
}

at::Tensor ViewPainter::decode(const at::Tensor& latents) const {
    const at::NoGradGuard no_grad;
    return (scene_.prior->decode_image(latents) / 2 + 0.5).clamp(0, 1);
}

void ViewPainter::paint(const ViewRender& render, const at::Tensor& image,
                        const at::Tensor& share) {
    const at::NoGradGuard no_grad;
    const auto [seen, counts] = render.colors_of(image);
    const at::Tensor weight = (share * counts * (scene_.weight.squeeze(1) > 0)).unsqueeze(1);
    // The first painted view replaces unpainted texels completely.
    const at::Tensor whole = (painted_ == 0).unsqueeze(1) & (weight > 0);
    colors_ = at::where(whole, seen, colors_.lerp(seen, weight));
    painted_ =
        at::where(weight.squeeze(1) > 0, at::maximum(painted_, render.texels().cosine), painted_);
}

bool ViewPainter::is_painted_at_all() const {
    return (painted_ > 0).any().item<bool>();
}

}  // namespace item3d
