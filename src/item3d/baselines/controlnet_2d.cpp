#include "item3d/baselines/controlnet_2d.h"

#include "item3d/baselines/leftovers.h"
#include "item3d/baselines/view_lists.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr int controlnet_steps = 20;  ///< with DDIM, as in ControlNet's own demonstration

}  // namespace

Controlnet2d::Controlnet2d(const PaintingScene& scene, const PainterOptions& options)
    : ViewPainter(scene, options) {
    if (options_.steps == 0) options_.steps = controlnet_steps;
}

std::int64_t Controlnet2d::step_count(const PainterOptions& options) {
    return first_views(ring_and_poles(), options.views).size();
}

void Controlnet2d::step(std::int64_t index) {
    const ViewAngles angles = ring_and_poles()[static_cast<std::size_t>(index)];
    const ViewRender render(scene_, side_view(scene_, angles));
    MaskedSampling sampling;
    sampling.steps = options_.steps;
    sampling.image = encode(render.image(scene_.source));  // only its size is used
    sampling.noise = seeded_noise(sampling.image.sizes(), options_.seed, BaselineDraw::views,
                                  static_cast<std::uint64_t>(index))
                         .to(sampling.image.device());
    const at::Tensor image = decode(sample_masked(guided(render, sampling.image), sampling));
    images_.push_back(image);
    const at::Tensor& cosine = render.texels().cosine;
    paint(render, image, (cosine > painted_).to(at::kFloat));
}

void Controlnet2d::finish() {
    colors_ = at::where(scene_.weight > 0,
                        fill_from_neighbours(*scene_.texels, colors_, painted_ > 0), colors_);
}

}  // namespace item3d
