#include "item3d/baselines/texture_painter.h"

#include "item3d/baselines/leftovers.h"
#include "item3d/baselines/view_lists.h"

namespace item3d {
namespace {

constexpr int texture_steps = 50;
/// Range of steps in which an inpainting network draws, as shares of all steps: steps 11 to 19 of
/// 50.
constexpr double inpainting_after = 10.0 / 50, inpainting_before = 20.0 / 50;
constexpr double hidden_grey = 0.5;  ///< grey of the part hidden from an inpainting network

}  // namespace

at::Tensor drawn_cells(const Trimap& map, std::int64_t height, std::int64_t width, int step,
                       int steps) {
    const at::Tensor update = any_in_cells(map.update, height, width);
    if (2 * step >= steps) return update;
    const auto options = map.update.options();
    const at::Tensor y = at::arange(height, options).view({-1, 1});
    const at::Tensor x = at::arange(width, options).view({1, -1});
    const at::Tensor board =
        ((y / 2).floor() + (x / 2).floor()).remainder(2).view({1, 1, height, width});
    const at::Tensor generate = any_in_cells(map.generate * map.update, height, width);
    return at::maximum(generate, update * board);
}

TexturePainter::TexturePainter(const PaintingScene& scene, const PainterOptions& options)
    : ViewPainter(scene, options) {
    if (options_.steps == 0) options_.steps = texture_steps;
}

std::int64_t TexturePainter::step_count(const PainterOptions& options) {
    return static_cast<std::int64_t>(first_views(ring_and_poles(), options.views).size());
}

TrimapInput TexturePainter::look(const ViewRender& render) const {
    const at::Tensor best = painted_.unsqueeze(1);
    return {render.covered(), render.editable(),
            (render.pixels((best == 0).to(at::kFloat)) > 0.5).to(at::kFloat), render.cosine(),
            render.pixels(best)};
}

void TexturePainter::step(std::int64_t index) {
    const at::NoGradGuard no_grad;
    const ViewAngles angles = ring_and_poles()[static_cast<std::size_t>(index)];
    const ViewRender render(scene_, side_view(scene_, angles));
    const TrimapInput input = look(render);
    const Trimap map = make_trimap(input);
    const at::Tensor rendered = render.image(colors_);
    if (map.update.sum().item<float>() == 0) {  // nothing to paint in this view
        images_.push_back(rendered);
        return;
    }
    MaskedSampling sampling;
    sampling.sampler = "pndm";
    sampling.steps = options_.steps;
    sampling.image = encode(rendered);
    const std::int64_t height = sampling.image.size(2), width = sampling.image.size(3);
    sampling.noise = seeded_noise(sampling.image.sizes(), options_.seed, BaselineDraw::views, 0)
                         .to(sampling.image.device());
    sampling.drawn = [&](int step) {
        return drawn_cells(map, height, width, step, options_.steps);
    };
    const GuidedModel model = guided(render, sampling.image);
    std::optional<GuidedModel> inpainter;
    if (scene_.inpainter && is_painted_at_all()) {
        const at::Tensor hidden =
            at::upsample_nearest2d(any_in_cells(map.update, rendered.size(2), rendered.size(3)),
                                   {rendered.size(2), rendered.size(3)});
        inpainter.emplace(*scene_.inpainter, prompt_of_side(scene_, render.view().side),
                          scene_.negative_prompt, options_.cfg);
        inpainter->condition = inpainting_condition(
            any_in_cells(map.update, height, width),
            scene_.inpainter->encode_image(at::where(hidden > 0, hidden_grey, rendered) * 2 - 1));
        sampling.inpainter = &*inpainter;
        sampling.inpaints = [&](int step) {
            return step > inpainting_after * options_.steps &&
                   step < inpainting_before * options_.steps;
        };
    }
    const at::Tensor image = decode(sample_masked(model, sampling));
    const at::Tensor mask = projection_mask(input, map.update);
    const at::Tensor share =
        sample_image(mask[0], render.texels().place).squeeze(1) * (render.texels().cosine > 0);
    paint(render, image, share);
    images_.push_back(image);
}

void TexturePainter::finish() {
    colors_ = at::where(scene_.weight > 0, fill_with_mean(colors_, painted_ > 0), colors_);
}

}  // namespace item3d
